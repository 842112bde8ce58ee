/* Variants: which programs belong to which specialised kernels, which of these are alive, and programs that
 * another device made for one. */
#include "base/gl_private.h"

#include "base/memory.h"

#include <string.h>

void gw_gl_variant_mark(const gw_gl *device, gw_gl_cached_program *program, int made) {
    if (device->variant < 0)
        program->variants = 0;
    else if (made || program->variants)
        program->variants |= UINT32_C(1) << device->variant;
}

static void delete_variant(gw_gl *device, int place) {
    const uint32_t bit = UINT32_C(1) << place;
    size_t kept = 0;
    for (size_t i = 0; i < device->program_count; i++) {
        gw_gl_cached_program *program = &device->programs[i];
        if (program->variants == bit) {
            gw_gl_program_free(program);
            device->programs_deleted++;
            continue;
        }
        program->variants &= ~bit;
        device->programs[kept++] = *program;
    }
    device->program_count = kept;
}

void gw_gl_variant_begin(gw_gl *device, gw_hash key) {
    int place = 0;
    for (int i = 0; i < GW_GL_VARIANTS; i++) {
        const gw_gl_variant *variant = &device->variants[i];
        if (variant->begun && gw_hash_equal(variant->key, key)) {
            place = i;
            break;
        }
        if (variant->begun < device->variants[place].begun)
            place = i;
    }
    gw_gl_variant *variant = &device->variants[place];
    if (variant->begun && !gw_hash_equal(variant->key, key))
        delete_variant(device, place);
    variant->key = key;
    variant->begun = ++device->variants_begun;
    device->variant = place;
}

void gw_gl_variant_end(gw_gl *device) {
    device->variant = -1;
    device->expected = 0;
}

gw_gl_variant_counts gw_gl_variant_counts_of(const gw_gl *device) {
    gw_gl_variant_counts counts = {.programs = device->program_count, .deleted = device->programs_deleted};
    for (int i = 0; i < GW_GL_VARIANTS; i++) {
        counts.alive += device->variants[i].begun > 0;
    }
    return counts;
}

/* Where the variant of this key is, -1: it is not alive. */
static int place_of(const gw_gl *device, gw_hash key) {
    for (int i = 0; i < GW_GL_VARIANTS; i++)
        if (device->variants[i].begun && gw_hash_equal(device->variants[i].key, key))
            return i;
    return -1;
}

int gw_gl_variant_lives(const gw_gl *device, gw_hash key) {
    return place_of(device, key) >= 0;
}

/* The device's own program of this name and defines, or NULL. */
static gw_gl_cached_program *twin_of(const gw_gl *device, const gw_gl_cached_program *program) {
    for (size_t i = 0; i < device->program_count; i++) {
        gw_gl_cached_program *own = &device->programs[i];
        if (strcmp(own->name, program->name) == 0 && strcmp(own->defines, program->defines) == 0)
            return own;
    }
    return NULL;
}

gw_code gw_gl_variant_adopt(gw_gl *device, gw_gl *from, gw_hash key, gw_error *error) {
    const int place = place_of(from, key);
    if (place < 0)
        return gw_fail(error, GW_MACHINE, "the kernels that were made in the background are gone");
    void *programs = device->programs;
    gw_code code = gw_grow(&programs, &device->program_capacity, device->program_count + from->program_count,
                           sizeof(gw_gl_cached_program), "programs", error);
    device->programs = programs;
    if (code)
        return code;
    size_t kept = 0;
    gw_gl_variant_begin(device, key);
    for (size_t i = 0; i < from->program_count; i++) {
        gw_gl_cached_program program = from->programs[i];
        gw_gl_cached_program *twin =
            program.variants & (UINT32_C(1) << place) ? twin_of(device, &program) : NULL;
        if (!(program.variants & (UINT32_C(1) << place)) || twin) {
            if (twin)
                gw_gl_variant_mark(device, twin, 0);
            from->programs[kept++] = program;
            continue;
        }
        program.variants = 0;
        program.ran = 0; /* software GL compiles once more in this context */
        gw_gl_variant_mark(device, &program, 1);
        device->programs[device->program_count++] = program;
    }
    gw_gl_variant_end(device);
    from->program_count = kept;
    return GW_OK;
}

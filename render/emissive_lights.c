/* See emissive_lights.h. */
#include "render/emissive_lights.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A cluster whose places deviate by less than this share of the box's diagonal is not cut further. */
static const double compact = 0.05;
/* Triangles one behind the other are taken together where there are more than that. */
enum { MOST_ATOMS = 1 << 14 };
enum { LEAST_SLOTS = 16, SLOTS_OF_TRIANGLE = 4 };

typedef struct emitter {
    uint32_t triangle;
    float radiance[3];
    double area, power; /* m^2; luminance times that */
} emitter;

/* Emitters one behind the other; moments of their places by power. */
typedef struct atom {
    uint32_t first, end;
    double power, moment[3], squares;
} atom;

typedef struct cluster {
    uint32_t first, end; /* of the order of atoms */
    atom sum;
} cluster;

typedef struct gathering {
    const gw_scene *scene;
    emitter *emitters;
    uint32_t emitter_count;
    atom *atoms;
    uint32_t atom_count;
    uint32_t *order; /* atoms, cluster by cluster */
    cluster clusters[GW_MAXIMUM_EMISSIVE_LIGHTS];
    uint32_t cluster_count;
} gathering;

static double luminance(const float rgb[3]) {
    return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

static void corner_of(const gw_scene *scene, uint32_t triangle, int k, double out[3]) {
    const float *p = scene->positions + (size_t)scene->triangles[triangle][k] * 3;
    for (int i = 0; i < 3; ++i)
        out[i] = ldexp((double)p[i], scene->exponent);
}

/* Of a triangle, m, about the scene's centre. */
typedef struct extent {
    double area, middle[3], variance; /* of its places */
} extent;

static extent extent_of(const gw_scene *scene, uint32_t triangle) {
    double a[3], b[3], c[3], n[3];
    extent out = {0};
    corner_of(scene, triangle, 0, a);
    corner_of(scene, triangle, 1, b);
    corner_of(scene, triangle, 2, c);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double m = (a[i] + b[i] + c[i]) / 3.0;
        n[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
        out.middle[i] = m;
        out.variance += ((a[i] - m) * (a[i] - m) + (b[i] - m) * (b[i] - m) + (c[i] - m) * (c[i] - m)) / 12.0;
    }
    out.area = 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return out;
}

/* Of the brightest channel; what unlit materials show is no light. */
static float radiance_of(const gw_scene *scene, uint32_t material) {
    const float *rgb = scene->materials[material].emissive;
    if (scene->extensions && scene->extensions[material].unlit)
        return 0.0f;
    return fmaxf(fmaxf(rgb[0], rgb[1]), rgb[2]);
}

static emitter emitter_of(const gw_scene *scene, uint32_t triangle) {
    emitter e = {.triangle = triangle, .area = extent_of(scene, triangle).area};
    memcpy(e.radiance, scene->materials[scene->material_of[triangle]].emissive, sizeof e.radiance);
    e.power = e.area * luminance(e.radiance);
    return e;
}

static gw_code gather(gathering *g, float faintest, gw_emissive_lights *out, gw_error *error) {
    const gw_scene *scene = g->scene;
    uint32_t count = 0;
    double faint = 0.0, all = 0.0;
    for (uint32_t i = 0; i < scene->triangle_count; ++i)
        count += radiance_of(scene, scene->material_of[i]) > 0.0f;
    if (count == 0)
        return GW_OK;
    gw_code code =
        gw_allocate((void **)&g->emitters, count, sizeof *g->emitters, "emissive triangles", error);
    for (uint32_t i = 0; !code && i < scene->triangle_count; ++i) {
        const float radiance = radiance_of(scene, scene->material_of[i]);
        if (!(radiance > 0.0f))
            continue;
        const emitter e = emitter_of(scene, i);
        const int is_faint = radiance < faintest;
        all += e.power;
        faint += is_faint ? e.power : 0.0;
        out->faint_triangles += is_faint != 0;
        if (!is_faint && e.power > 0.0)
            g->emitters[g->emitter_count++] = e;
    }
    out->faint = faint > 0.0 ? faint / all : 0.0;
    return code;
}

static void add(atom *to, const atom *from, double sign) {
    to->power += sign * from->power;
    to->squares += sign * from->squares;
    for (int i = 0; i < 3; ++i)
        to->moment[i] += sign * from->moment[i];
}

/* Power times variance of places. */
static double spread_of(const atom *a) {
    const double *m = a->moment;
    return a->power > 0.0 ? fmax(a->squares - (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]) / a->power, 0.0)
                          : 0.0;
}

static gw_code make_atoms(gathering *g, gw_error *error) {
    const uint32_t each = (g->emitter_count + MOST_ATOMS - 1) / MOST_ATOMS;
    g->atom_count = (g->emitter_count + each - 1) / each;
    gw_code code = gw_allocate((void **)&g->atoms, g->atom_count, sizeof *g->atoms, "emissive parts", error);
    if (!code)
        code = gw_allocate((void **)&g->order, g->atom_count, sizeof *g->order, "emissive parts", error);
    for (uint32_t k = 0; !code && k < g->atom_count; ++k) {
        atom *a = &g->atoms[k];
        a->first = k * each;
        a->end = k + 1 < g->atom_count ? a->first + each : g->emitter_count;
        for (uint32_t i = a->first; i < a->end; ++i) {
            const emitter *e = &g->emitters[i];
            const extent size = extent_of(g->scene, e->triangle);
            atom one = {.power = e->power, .squares = e->power * size.variance};
            for (int c = 0; c < 3; ++c) {
                one.moment[c] = e->power * size.middle[c];
                one.squares += e->power * size.middle[c] * size.middle[c];
            }
            add(a, &one, 1.0);
        }
        g->order[k] = k;
    }
    return code;
}

/* --- clusters --- */

typedef struct keyed {
    double key;
    uint32_t atom;
} keyed;

static int by_key(const void *a, const void *b) {
    const keyed *x = a, *y = b;
    return x->key != y->key ? (x->key < y->key ? -1 : 1) : x->atom < y->atom ? -1 : x->atom > y->atom;
}

static int by_number(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

static int longest_axis(const gathering *g, const cluster *c) {
    double variance[3] = {0};
    for (uint32_t i = c->first; i < c->end; ++i) {
        const atom *a = &g->atoms[g->order[i]];
        for (int k = 0; k < 3; ++k) {
            const double off = a->moment[k] / a->power - c->sum.moment[k] / c->sum.power;
            variance[k] += a->power * off * off;
        }
    }
    const int axis = variance[1] > variance[0];
    return variance[2] > variance[axis] ? 2 : axis;
}

/* Where both sides' spreads are least, of atoms in the order of the axis; scratch: room for its atoms. 0
 * where no cut lowers it. */
static int cut(gathering *g, cluster *c, cluster *second, keyed *scratch) {
    const uint32_t count = c->end - c->first;
    const int axis = longest_axis(g, c);
    double least = spread_of(&c->sum);
    uint32_t at = 0;
    atom before = {0}, sums[2] = {{0}};
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t number = g->order[c->first + i];
        scratch[i] = (keyed){g->atoms[number].moment[axis] / g->atoms[number].power, number};
    }
    qsort(scratch, count, sizeof *scratch, by_key);
    for (uint32_t i = 0; i + 1 < count; ++i) {
        atom after = c->sum;
        add(&before, &g->atoms[scratch[i].atom], 1.0);
        add(&after, &before, -1.0);
        const double sum = spread_of(&before) + spread_of(&after);
        if (sum < least * (1.0 - 1e-9)) {
            least = sum;
            at = i + 1;
        }
    }
    if (at == 0)
        return 0;
    for (uint32_t i = 0; i < count; ++i) { /* summed anew: differences lose small parts */
        g->order[c->first + i] = scratch[i].atom;
        add(&sums[i >= at], &g->atoms[scratch[i].atom], 1.0);
    }
    *second = (cluster){c->first + at, c->end, sums[1]};
    *c = (cluster){c->first, c->first + at, sums[0]};
    return 1;
}

static gw_code cut_clusters(gathering *g, uint32_t most, gw_error *error) {
    keyed *scratch = NULL;
    int closed[GW_MAXIMUM_EMISSIVE_LIGHTS] = {0};
    double diagonal = 0.0;
    for (int i = 0; i < 3; ++i)
        diagonal += (g->scene->bounds[1][i] - g->scene->bounds[0][i]) *
                    (g->scene->bounds[1][i] - g->scene->bounds[0][i]);
    gw_code code = gw_allocate((void **)&scratch, g->atom_count, sizeof *scratch, "emissive parts", error);
    if (code)
        return code;
    g->clusters[0] = (cluster){.end = g->atom_count};
    for (uint32_t i = 0; i < g->atom_count; ++i)
        add(&g->clusters[0].sum, &g->atoms[i], 1.0);
    g->cluster_count = 1;
    while (g->cluster_count < most) {
        uint32_t widest = g->cluster_count;
        for (uint32_t i = 0; i < g->cluster_count; ++i) {
            const double spread = spread_of(&g->clusters[i].sum);
            if (!closed[i] && spread > compact * compact * diagonal * g->clusters[i].sum.power &&
                (widest == g->cluster_count || spread > spread_of(&g->clusters[widest].sum)))
                widest = i;
        }
        if (widest == g->cluster_count)
            break;
        if (cut(g, &g->clusters[widest], &g->clusters[g->cluster_count], scratch))
            ++g->cluster_count;
        else
            closed[widest] = 1;
    }
    free(scratch);
    for (uint32_t i = 0; i < g->cluster_count; ++i) /* along the curve again */
        qsort(g->order + g->clusters[i].first, g->clusters[i].end - g->clusters[i].first, sizeof *g->order,
              by_number);
    return GW_OK;
}

/* --- slots --- */

static uint32_t triangles_of(const gathering *g, const cluster *c) {
    uint32_t count = 0;
    for (uint32_t i = c->first; i < c->end; ++i)
        count += g->atoms[g->order[i]].end - g->atoms[g->order[i]].first;
    return count;
}

static uint32_t slots_for(uint32_t triangles) {
    uint32_t slots = LEAST_SLOTS;
    while (slots < SLOTS_OF_TRIANGLE * (uint64_t)triangles && slots < GW_MOST_EMISSIVE_SLOTS)
        slots *= 2;
    return slots;
}

/* Slots whose middles lie within the emitter's stretch of the cluster's power; each covers the part of the
 * triangle that its stretch overlaps, the outermost ones all that is left of it on their side. */
static uint32_t fill_slots(const gathering *g, const emitter *e, double from, double power, uint32_t slots,
                           gw_emissive_slot *out) {
    const double begin = from / power * slots, end = (from + e->power) / power * slots;
    const uint32_t first = (uint32_t)fmax(ceil(begin - 0.5), 0.0),
                   last = (uint32_t)fmin(ceil(end - 0.5), (double)slots);
    const double scale = power / luminance(e->radiance) * ldexp(1.0, -2 * g->scene->exponent);
    const int both = g->scene->materials[g->scene->material_of[e->triangle]].two_sided;
    for (uint32_t s = first; s < last; ++s) {
        const double low = s == first ? 0.0 : (s - begin) / (end - begin),
                     high = s + 1 == last ? 1.0 : (s + 1 - begin) / (end - begin);
        gw_emissive_slot *slot = &out[s];
        slot->words[0] = e->triangle;
        slot->words[1] = both ? GW_EMITS_BOTH_WAYS : 0;
        memcpy(&slot->words[2], &(float){(float)low}, sizeof(float));
        memcpy(&slot->words[3], &(float){(float)(high - low)}, sizeof(float));
        for (int c = 0; c < 3; ++c)
            slot->light[c] = (float)((double)e->radiance[c] * power / luminance(e->radiance));
        slot->light[3] = (float)scale;
    }
    return last > first ? last - first : 0;
}

static void make_light(const gathering *g, const cluster *c, uint32_t slots, gw_emissive_light *out,
                       gw_emissive_slot *rows) {
    double from = 0.0;
    *out = (gw_emissive_light){.slot_count = slots, .triangles = triangles_of(g, c)};
    out->deviation = sqrt(spread_of(&c->sum) / c->sum.power);
    for (int i = 0; i < 3; ++i)
        out->middle[i] = g->scene->centre[i] + c->sum.moment[i] / c->sum.power;
    for (uint32_t i = c->first; i < c->end; ++i)
        for (uint32_t k = g->atoms[g->order[i]].first; k < g->atoms[g->order[i]].end; ++k) {
            const emitter *e = &g->emitters[k];
            if (fill_slots(g, e, from, c->sum.power, slots, rows) == 0)
                out->folded += e->power / c->sum.power;
            from += e->power;
            out->area += e->area;
            for (int j = 0; j < 3; ++j)
                out->color[j] += (double)e->radiance[j] * e->area;
        }
}

static gw_code make_lights(const gathering *g, gw_emissive_lights *out, gw_error *error) {
    for (uint32_t i = 0; i < g->cluster_count; ++i)
        out->slot_count += slots_for(triangles_of(g, &g->clusters[i]));
    gw_code code =
        gw_allocate((void **)&out->slots, out->slot_count, sizeof *out->slots, "emissive lights", error);
    uint32_t first = 0;
    for (uint32_t i = 0; !code && i < g->cluster_count; ++i) {
        gw_emissive_light *light = &out->lights[out->count++];
        make_light(g, &g->clusters[i], slots_for(triangles_of(g, &g->clusters[i])), light,
                   out->slots + first);
        light->first_slot = first;
        first += light->slot_count;
    }
    return code;
}

gw_code gw_emissive_lights_make(const gw_scene *scene, uint32_t most, float faintest, gw_emissive_lights *out,
                                gw_error *error) {
    gathering g = {.scene = scene};
    memset(out, 0, sizeof *out);
    if (most == 0)
        return GW_OK;
    if (most > GW_MAXIMUM_EMISSIVE_LIGHTS)
        most = GW_MAXIMUM_EMISSIVE_LIGHTS;
    gw_code code = gather(&g, faintest, out, error);
    if (!code && g.emitter_count > 0) {
        code = make_atoms(&g, error);
        if (!code)
            code = cut_clusters(&g, most, error);
        if (!code)
            code = make_lights(&g, out, error);
    }
    free(g.emitters);
    free(g.atoms);
    free(g.order);
    if (code)
        gw_emissive_lights_finish(out);
    return code;
}

void gw_emissive_lights_finish(gw_emissive_lights *lights) {
    free(lights->slots);
    memset(lights, 0, sizeof *lights);
}

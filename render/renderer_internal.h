/* What the renderer's sources share; private to render/renderer*.c. */
#ifndef GW_RENDER_RENDERER_INTERNAL_H
#define GW_RENDER_RENDERER_INTERNAL_H

#include "render/features.h"
#include "render/frame_block.h"
#include "render/luminance.h"
#include "render/moving.h"
#include "render/renderer.h"
#include "render/scene_buffers.h"
#include "render/transmission.h"

/* Storage bindings of trace/primary.comp, trace/rays.comp and shade/shade.comp. */
enum gw_binding {
    GW_BINDING_FRAGMENTS = 0, /* rays, for rays.comp and brute_force.comp */
    GW_BINDING_STATUSES = 1,  /* hits */
    GW_BINDING_STATES = 2,
    GW_BINDING_TOTALS = 3,
    GW_BINDING_QUEUE = 4,
    GW_BINDING_NEXT_QUEUE = 5,
    GW_BINDING_WORK = 6,
    GW_BINDING_SUMS = 7,
    GW_BINDING_PIXELS = 8,
    GW_BINDING_SAMPLES = 9,
    GW_BINDING_BLOCKS = 10,
    GW_BINDING_NODES = 11, /* these three with STORAGE_FETCH only */
    GW_BINDING_REFERENCES = 12,
    GW_BINDING_TRIANGLES = 13,
    GW_BINDING_ACCUMULATED = 14, /* with ACCUMULATE only */
    GW_BINDING_VISIBILITIES = 15,
    GW_BINDING_SHADOW_RAYS = 16,
    GW_BINDING_GIVEN_RAYS = 17, /* this one and GIVEN_SUMS with REFLECTED only */
    GW_BINDING_RADIANCE = 18,   /* of the secondary rays that fragments have asked for */
    GW_BINDING_ASKED = 19,
    GW_BINDING_REQUESTS = 20,
    GW_BINDING_GUIDES = 21,
    GW_BINDING_CELL_COLORS = 22,
    GW_BINDING_CELL_POINTS = 23,
    GW_BINDING_CELL_MARKS = 24,
    GW_BINDING_LISTS = 25,
    GW_BINDING_NEXT_RAYS = 26,
    GW_BINDING_GIVEN_SUMS = 27,
    GW_BINDING_MEDIA = 28,        /* with TRANSMISSION only */
    GW_BINDING_OUT_OF_RANGE = 29, /* with CHECK_FETCHES only */
    GW_BINDING_LUMINANCES = 30    /* with METERING only */
};
/* Texture units of what shaders/blend reads, beside those of gw_scene_buffers_bind(). */
enum gw_unit { GW_UNIT_CELL_COLORS = 14, GW_UNIT_CELL_POINTS = 15, GW_UNIT_CELL_MARKS = 16 };
/* Of the kernels of shaders/sample, before a batch is traced. */
enum gw_list_binding {
    GW_LIST_BINDING_RATES = 0,
    GW_LIST_BINDING_COUNTS = 1,
    GW_LIST_BINDING_GROUP_SUMS = 2,
    GW_LIST_BINDING_LIST = 3
};

enum { GW_BLOCK_SIDE = 8, GW_BLOCK_PIXELS = 64 };

/* Buffers of one chunk of rays ("slots"); they only grow. */
typedef struct gw_ray_buffers {
    size_t slots;
    size_t fragment_words; /* of all slots */
    int has_work;
    gw_gl_buffer fragments, statuses, states, queues[2], work, sums, pixels, media;
} gw_ray_buffers;

/* What a chunk of sparse samples has beside the rays of a batch of them; made with the first such chunk, and
 * they only grow. */
typedef struct gw_sample_buffers {
    gw_gl_buffer rates, counts, group_sums; /* of the list under way */
    gw_gl_buffer list;                      /* GW_LIST_ARGUMENTS words, then the arguments of each batch */
    gw_gl_buffer samples, blocks, sums, guides, pixels;
    gw_gl_buffer lists;                                /* of blend/lists.glsl */
    gw_gl_buffer cell_colors, cell_points, cell_marks; /* of blend/cells.glsl; the last two with guides */
} gw_sample_buffers;
/* Shadow rays of what one dispatch has met; exist only if a frame cast shadows, only grow. */
typedef struct gw_shadow_buffers {
    gw_gl_buffer visibilities;      /* of every fragment and light */
    gw_gl_buffer rays;              /* those that are traced: places in visibilities */
    gw_gl_buffer states, queues[2]; /* of one batch */
} gw_shadow_buffers;

/* Secondary rays of what one dispatch has met, of one bounce; exist only if a frame calls for them, only
 * grow. */
typedef struct gw_secondary_buffers {
    gw_gl_buffer asked;    /* of every fragment: which rays it asks for */
    gw_gl_buffer requests; /* fragments, by number of the ray */
    gw_gl_buffer rays;     /* of one batch */
    gw_gl_buffer radiance; /* by number of the ray */
    gw_ray_buffers traced;
    gw_shadow_buffers shadows;
} gw_secondary_buffers;

/* What a still view's samples depend on besides scene and renderer. Compared as bytes: made of zeros first.
 */
typedef struct gw_accumulation_view {
    gw_frame_state state; /* of gw_frame_state_view() */
    gw_similarity placement;
    gw_plane plane;
    gw_rectangle rectangle;
} gw_accumulation_view;

/* The samples of the last view so far; exists only once a frame asked for it. */
typedef struct gw_accumulation {
    gw_accumulation_view view;
    uint32_t samples;     /* that the sums and pixels hold */
    gw_frame_state toned; /* what made the pixels of the sums */
    int metered;          /* luminance holds their light */
    gw_luminance luminance;
    gw_gl_buffer *chunks; /* sums of linear radiance, a buffer for each chunk of the rectangle */
    size_t chunk_count, chunk_capacity;
    uint8_t *rgba; /* the rectangle's pixels */
    size_t rgba_capacity;
} gw_accumulation;

/* Kernels that the renderer has drawn with. */
typedef struct gw_variant_drawn {
    gw_hash hash;
    gw_features features;
    int guides; /* as in their key */
} gw_variant_drawn;

/* renderer_background.c: kernels that are made by a thread of their own. */
typedef struct gw_background gw_background;

struct gw_renderer {
    gw_gl *device;
    const gw_scene *scene;   /* at `time`, if it moves */
    const gw_scene *still;   /* as it was made: what lights are made of */
    const gw_octree *octree; /* of that */
    gw_moving *moving;       /* NULL unless the scene moves */
    int64_t time;            /* ns, for which scene and octree stand */
    const gw_log *log;
    int count, one_kernel, time_blending;
    int64_t blend_ns; /* with time_blending: since it was last asked for */
    uint32_t loop_budget;
    uint32_t loop_iterations;   /* the most of a ray in a dispatch since the frame or the tracing began */
    gw_features scene_features; /* but for the forbidden ones */
    float mirror_roughness, glossy_roughness; /* that they were taken with */
    gw_light_knobs light_knobs;               /* that the scene's lights were made with */
    gw_features forced_features, forbidden_features;
    gw_features last_features; /* of the last frame, for the report */
    int has_drawn;             /* there was one */
    gw_scene_buffers buffers;
    gw_media media;
    gw_ray_buffers rays;
    gw_shadow_buffers shadows;
    gw_secondary_buffers secondary[GW_MOST_BOUNCES + 1]; /* what rays of each bounce ask for */
    gw_gl_buffer totals, frame;
    gw_gl_buffer out_of_range;           /* made with the first frame that checks its reads */
    gw_gl_buffer luminances;             /* made with the first frame whose light is counted */
    gw_luminance luminance;              /* since it was last asked for */
    gw_gl_buffer given_rays, found_hits; /* of gw_renderer_trace */
    gw_sample_buffers samples;
    uint8_t *host_pixels; /* of one chunk, 4 bytes each, row by row */
    size_t host_pixel_capacity;
    gw_accumulation accumulation;
    gw_accumulation other_accumulation; /* of the view that is not drawn now */
    uint32_t chosen_view;
    gw_kernel_making kernels;
    gw_variant_drawn variants[GW_GL_VARIANTS];
    gw_background *background; /* NULL until kernels are made there */
    uint32_t stood_in;         /* frames that were drawn by kernels that know more than they called for */
};

/* What a renderer has on the GPU beside the scene: what it needs from the first frame on; all of it. */
gw_code gw_renderer_make_own_buffers(gw_renderer *renderer, gw_error *error);
void gw_renderer_finish_buffers(gw_renderer *renderer);
/* Room for slots rays of pixels, bound with all that kernels of frames read and write. */
gw_code gw_renderer_reserve(gw_renderer *renderer, size_t slots, uint32_t fragments, int work,
                            gw_error *error);
/* Room for slots rays; fragment words and work only as asked, pixels only in the renderer's own. */
gw_code gw_ray_buffers_reserve(gw_renderer *renderer, gw_ray_buffers *rays, size_t slots, uint32_t fragments,
                               int work, gw_error *error);
void gw_ray_buffers_bind(const gw_ray_buffers *rays); /* all but sums and pixels */
void gw_ray_buffers_finish(gw_ray_buffers *buffers);
uint64_t gw_ray_buffers_bytes(const gw_ray_buffers *buffers);
/* Makes the buffer at least that large; contents are lost when it grows. */
gw_code gw_renderer_grow(gw_renderer *renderer, gw_gl_buffer *buffer, const char *name, size_t size,
                         gw_error *error);
/* Of the state, but for what is forbidden. */
gw_light_knobs gw_renderer_light_knobs(const gw_renderer *renderer, const gw_frame_state *state);
/* What its scene and octree call for. */
gw_code gw_renderer_take_features(gw_renderer *renderer, gw_error *error);
/* Clears the totals of shaders/common/frame.h, or reads them. */
gw_code gw_renderer_clear_totals(gw_renderer *renderer, gw_error *error);
gw_code gw_renderer_read_totals(gw_renderer *renderer, uint32_t totals[GW_TOTAL_WORDS], gw_error *error);
/* Adds the counted work of the first `slots` rays. */
gw_code gw_ray_buffers_add_work(const gw_ray_buffers *rays, size_t slots, gw_counters *counters,
                                gw_error *error);
/* The kernel for a key; more_defines may be NULL. */
gw_code gw_renderer_kernel(gw_renderer *renderer, const char *name, const gw_kernel_key *key,
                           const char *more_defines, GLuint *out, gw_error *error);
/* Rays that one chunk may hold: dispatches stay short on software GL. */
size_t gw_renderer_chunk_slots(const gw_renderer *renderer);
/* Samples and blocks a side that a chunk with sparse samples may hold: its lists, not its batches of rays. */
enum { GW_MOST_SAMPLES = 1 << 22, GW_MOST_SPARSE_SIDE = 496 };
/* Bytes of one sample in the lists, and of one pixel: with a third of a cell and half a word of the work
 * lists. */
enum { GW_SAMPLE_BYTES = 4 + 16 + 16, GW_SAMPLE_PIXEL_BYTES = 4 + 14 + 2 };
/* With more lights than that which cast shadows, chunks are smaller in proportion. */
enum { GW_CHUNK_LIGHTS = 4 };

/* What decides what a ray of a pixel meets, and how that faces. */
#define GW_GEOMETRY_FEATURES                                                                                 \
    (GW_FEATURE_LOD | GW_FEATURE_GAZE | GW_FEATURE_ALPHA | GW_FEATURE_TEXTURES | GW_FEATURE_SQUARE_TEXELS |  \
     GW_FEATURE_SMOOTH_NORMALS | GW_NEEDED_FEATURES)

/* A frame under way. */
typedef struct gw_frame_job {
    gw_renderer *renderer;
    gw_kernel_key key;
    gw_frame_block block;
    gw_ray_buffers *rays; /* what it traces */
    gw_shadow_buffers *shadows;
    /* Of secondary rays: the rays themselves, and where in sums what they bring goes. NULL: rays of pixels.
     */
    const gw_gl_buffer *given, *sums;
    size_t sums_offset, sums_size;
    uint32_t bounce, bounces; /* of these rays, 0 for those of pixels; of the frame, at most */
    GLuint trace, shade;
    const gw_gl_buffer *arguments; /* of indirect dispatches of both; NULL: of as many slots as is said */
    size_t argument_offset;
    const gw_rectangle *rectangle;
    const gw_frame_state *state;
    uint32_t first_sample, end_sample; /* of a still view: those to be drawn; 0 and 1 without accumulation */
    size_t chunk;                      /* number of the present one */
    uint8_t *rgba;
    const gw_geometry *geometry; /* of gw_renderer_geometry(): where it goes; mm of a rebased unit */
    double unit;
    gw_counters counters;
} gw_frame_job;

/* renderer_batch.c: a program over the slots, or by the job's arguments; kernels for the job's key; one round
 * of them over slots, or with resume over the queue `from`; rounds over suspended rays. */
gw_code gw_frame_dispatch(gw_frame_job *job, GLuint program, size_t slots, gw_error *error);
gw_code gw_frame_kernels(gw_frame_job *job, int resume, gw_error *error);
gw_code gw_frame_round(gw_frame_job *job, size_t slots, int resume, int from, gw_error *error);
gw_code gw_frame_resume(gw_frame_job *job, uint32_t queue_length, gw_error *error);
/* renderer_frame.c: one batch of rays in slots from 0 on, also those that are suspended. */
gw_code gw_frame_batch(gw_frame_job *job, size_t slots, gw_error *error);
/* renderer_samples.c: the chunk's samples are listed, as often as needed traced, and made pixels, which are
 * in samples.pixels then. */
gw_code gw_frame_list_samples(gw_frame_job *job, gw_error *error);
gw_code gw_frame_samples(gw_frame_job *job, size_t pixel_slots, gw_error *error);
/* renderer_geometry.c: what a chunk's rays met, to where the job wants it. */
gw_code gw_frame_geometry(gw_frame_job *job, size_t block_count, gw_error *error);
/* Rays that a pixel of a block may take, whether the block is coarse or not. */
uint32_t gw_most_rays_of_pixel(const gw_frame_block *block);
/* Only lists them, and adds to the job's rays how many there are. */
gw_code gw_frame_count_samples(gw_frame_job *job, size_t block_count, gw_error *error);
void gw_sample_buffers_finish(gw_sample_buffers *buffers);
uint64_t gw_sample_buffers_bytes(const gw_sample_buffers *buffers);
/* renderer_shadows.c: how much of each light reaches what the slots, or with resume the queue, have met;
 * between trace and shade, counts what both totals held and clears them. Queues are left unbound. */
gw_code gw_frame_shadows(gw_frame_job *job, size_t slots, int resume, gw_error *error);
void gw_shadow_buffers_finish(gw_shadow_buffers *buffers);
uint64_t gw_shadow_buffers_bytes(const gw_shadow_buffers *buffers);
/* Room that one ray may need for its shadow rays. */
uint64_t gw_shadow_ray_bytes(uint32_t fragments, uint32_t lights, int tinted);
/* renderer_secondary.c: what the rays bring that what was met asks for; as gw_frame_shadows, and before it.
 * How a kind of ray is added stands in shaders/shade/secondary_kinds.glsl. */
gw_code gw_frame_secondary(gw_frame_job *job, size_t slots, int resume, gw_error *error);
/* Binds the buffers of the job's rays again, after rays of another bounce were traced. */
void gw_frame_bind_rays(const gw_frame_job *job);
void gw_secondary_buffers_finish(gw_secondary_buffers *buffers);
uint64_t gw_secondary_buffers_bytes(const gw_secondary_buffers *buffers);
/* Room that one ray may need for its secondary rays of one bounce, so many cones among them, but for what
 * traces them. */
uint64_t gw_secondary_ray_bytes(uint32_t fragments, uint32_t cones, gw_features asked);

/* Where a chunk's pixels are, row by row. */
static inline gw_gl_buffer *gw_frame_pixels(const gw_frame_job *job) {
    return job->key.features & GW_FEATURE_SPARSE ? &job->renderer->samples.pixels
                                                 : &job->renderer->rays.pixels;
}
/* renderer_tone.c: the frame's light will be counted from 0 on; what was counted. */
gw_code gw_frame_meter(gw_renderer *renderer, gw_error *error);
gw_code gw_frame_read_meter(gw_renderer *renderer, gw_luminance *out, gw_error *error);
/* Lines for the kernels that store pixels. */
const char *gw_tone_defines(gw_features features, char text[128]);
/* The pixels of a chunk once more from its sums. */
gw_code gw_frame_kept_pixels(gw_frame_job *job, size_t pixel_slots, gw_error *error);

/* renderer_variant.c: what the frame calls for; everything that chooses its kernels, with `more` effects than
 * those. */
gw_features gw_frame_calls_for(const gw_renderer *renderer, const gw_frame_state *state, uint32_t viewers);
gw_kernel_key gw_frame_key(const gw_renderer *renderer, const gw_frame_state *state, uint32_t viewers,
                           gw_features more);
/* 1 if kernels are made in the background where living ones can stand in. */
int gw_makes_in_background(const gw_renderer *renderer);
/* Begins the variant that the frame is drawn with, and makes job->key its key. */
gw_code gw_frame_choose_kernels(gw_frame_job *job, const gw_similarity *placement, const gw_plane *plane,
                                gw_error *error);
/* Begins the variant of job->key itself. */
gw_code gw_frame_own_kernels(const gw_frame_job *job, gw_error *error);
/* renderer_background.c. Asks for the kernels of a frame: 1 if they are being made, or others are, after
 * which it may ask again; 0: make them yourself. */
int gw_background_make(const gw_frame_job *job, const gw_similarity *placement, const gw_plane *plane,
                       gw_hash hash);
/* What was made meanwhile lives from here on. */
gw_code gw_background_take(gw_renderer *renderer, gw_error *error);
/* Until nothing is being made: before what the scene has on the GPU changes. Accepts NULL, as stop. */
void gw_background_wait(gw_background *background);
void gw_background_stop(gw_background **background);
/* Sets made, failed, busy; accepts NULL. */
void gw_background_count(gw_background *background, uint32_t *made, uint32_t *failed, int *busy);

/* renderer_lights.c: "lights" of gw_renderer_report(). */
gw_code gw_renderer_report_lights(const gw_renderer *renderer, json_t *report, gw_error *error);
/* renderer_effects.c: what effects get to do is counted from the first to the second. */
gw_code gw_effects_begin(gw_frame_job *job, gw_error *error);
gw_code gw_effects_end(gw_frame_job *job, gw_error *error);
/* renderer_accumulate.c: a frame of this view that shows `samples` samples; what is kept of another view, or
 * of more samples, is forgotten. */
gw_code gw_accumulation_begin(gw_accumulation *kept, const gw_accumulation_view *view, uint32_t samples,
                              gw_error *error);
/* Binds the sums of a chunk. */
gw_code gw_accumulation_bind(gw_renderer *renderer, size_t chunk, size_t pixel_slots, gw_error *error);
uint64_t gw_accumulation_bytes(const gw_accumulation *kept); /* on the GPU */
void gw_accumulation_finish(gw_accumulation *kept);

#endif

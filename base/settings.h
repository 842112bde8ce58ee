/* The one table of settings: everything that can change a pixel or the octree is one row here, with its unit,
 * range, default, the error it trades and the reference it is measured against. Command line (--set
 * name=value), files, reports, --help and the ledger all read this table; a setting that is not a row does
 * not exist.
 *
 * Adding a row adds the field, the option, the help text, the report entry and the range check. Any thread.
 */
#ifndef GW_BASE_SETTINGS_H
#define GW_BASE_SETTINGS_H

#include "base/status.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* GW_ROW(field, kind, default, minimum, maximum, choices, stage, unit, trades, reference, help)
 * kind: REAL, INTEGER, SWITCH (0 or 1) or CHOICE (index into choices, "a|b|c"). A REAL row whose choices are
 * "auto" also takes that word, which is stored as GW_SETTING_AUTO.
 * stage: BUILD (changes the octree's bytes), FRAME (travels in the frame state), TRACK (changes what rank 0
 * puts into it: eyes, gazes, automatic exposure). */
/* clang-format off */
#define GW_SETTINGS_TABLE(GW_ROW)                                                                                     \
    GW_ROW(outlier_extents, REAL, 1e6, 0.0, 1e30, "", BUILD, "extents", "far triangles against a scene shrunk to a point",    \
           "0 (keep all)", "triangles that reach farther than this many extents of the bulk of the scene are dropped")  \
    GW_ROW(octree_depth, INTEGER, 11, 1, 15, "", BUILD, "levels", "voxel size against memory and build time",          \
           "depth 15 or exact triangles (tau 0)", "deepest octree level; the root cube has side 2")                    \
    GW_ROW(leaf_triangles, INTEGER, 4, 0, 255, "", BUILD, "triangles", "tests per ray against nodes",                  \
           "any value gives the same pixels at tau 0", "a cell with at most this many triangles becomes a leaf (K)")   \
    GW_ROW(fan_rule, SWITCH, 1, 0, 1, "", BUILD, "", "tests per ray against nodes",                                    \
           "off gives the same pixels at tau 0", "a cell whose triangles all share one vertex becomes a leaf")         \
    GW_ROW(fan_cap, INTEGER, 32, 3, 1024, "", BUILD, "triangles", "tests per ray against nodes",                       \
           "any value gives the same pixels at tau 0", "largest fan that the fan rule keeps in one leaf")              \
    GW_ROW(isolation_rule, SWITCH, 1, 0, 1, "", BUILD, "", "small isolated things in coarse voxels against nodes",     \
           "off gives the same pixels at tau 0", "refine leaves whose triangles are a small isolated thing")           \
    GW_ROW(octree_memory, REAL, 0.0, 0.0, 1000000.0, "", BUILD, "MiB", "memory against tests per ray",                  \
           "0 gives the same pixels at tau 0",                                                                         \
           "most that the octree's arrays may take: cells that gain least are not refined; 0: what the driver reads")  \
    GW_ROW(dense_leaf, INTEGER, 64, 0, 65535, "", BUILD, "triangles", "tests per ray in dense cells against memory",   \
           "0 (plain lists) gives the same pixels at tau 0",                                                           \
           "a leaf with more triangles than this has boxes over its list (a small BVH); 0: none has")                  \
    GW_ROW(payload_texture_side, INTEGER, 256, 1, 4096, "", BUILD, "texels", "blur of textures in voxels against memory",      \
           "4096", "textures enter the voxels' colours through mip chains of at most this side")                       \
    GW_ROW(payload_rule, CHOICE, 0, 0, 1, "area|seed", BUILD, "", "colour and coverage of voxels against build time",   \
           "area", "how voxels average: by clipped area, or as Weier et al. 2014: every fragment alike, voxels solid") \
    GW_ROW(separation, REAL, 0.1, 0.0, 1.0, "", BUILD, "sides", "light through walls against solid foliage", "tau 0",  \
           "a voxel whose surface lies farther from its mean plane (root mean square) is flagged as separated")       \
    GW_ROW(geometry, CHOICE, 0, 0, 2, "hybrid|triangles|voxels", FRAME, "", "voxel error against triangle tests",       \
           "triangles", "what rays meet: triangles and voxels by footprint, triangles only, or finest voxels only")    \
    GW_ROW(tau, REAL, 1.0, 0.0, 64.0, "", FRAME, "footprints", "voxel error against steps and tests", "tau 0",         \
           "outside the gaze ellipsoid a cell no wider than tau footprints stands for its contents")                   \
    GW_ROW(tau_inside, REAL, 0.0, 0.0, 64.0, "", FRAME, "footprints", "voxel error against steps and tests", "tau 0",  \
           "tau inside the gaze ellipsoid; 0 is exact triangles")                                                      \
    GW_ROW(gaze_half_width, REAL, 8.0, 0.0, 90.0, "", FRAME, "deg", "sharp area against cost", "90 (no foveation)",    \
           "horizontal half-angle of the gaze ellipsoid")                                                              \
    GW_ROW(gaze_half_height, REAL, 6.0, 0.0, 90.0, "", FRAME, "deg", "sharp area against cost", "90 (no foveation)",   \
           "vertical half-angle of the gaze ellipsoid")                                                                \
    GW_ROW(gaze_margin, REAL, 3.0, 0.0, 45.0, "", FRAME, "deg", "tolerance to tracker error against cost", "45",       \
           "the acuity model starts this far outside the ellipsoid")                                                   \
    GW_ROW(gaze_blend, REAL, 2.0, 0.0, 45.0, "", FRAME, "deg", "visible border against cost", "45",                    \
           "tau grows from tau_inside to tau over this angle outside the ellipsoid")                                   \
    GW_ROW(gaze_growth, REAL, 300.0, 0.0, 1000.0, "", FRAME, "deg/s", "late gaze against cost", "1000",                \
           "the ellipsoid's half-angles grow by this per second of gaze age beyond gaze_latency")                      \
    GW_ROW(gaze_latency, REAL, 0.05, 0.0, 10.0, "", FRAME, "s", "late gaze against cost", "0",                         \
           "gaze age that is normal and does not widen the ellipsoid")                                                 \
    GW_ROW(gaze_growth_limit, REAL, 15.0, 0.0, 90.0, "", FRAME, "deg", "late gaze against cost", "90",                 \
           "most that gaze age adds to each half-angle")                                                               \
    GW_ROW(acuity_slope, REAL, 0.022, 0.0, 0.2, "", FRAME, "deg/deg", "blur in the periphery against cost", "0",       \
           "growth of the smallest resolvable period with eccentricity (m of MAR(e) = 1/48 + m e)")                    \
    GW_ROW(gaze_rule, CHOICE, 0, 0, 1, "acuity|seed", FRAME, "", "what is seen against cost", "acuity",                       \
           "what falls off outside the ellipsoid: what eyes resolve, or as Weier et al. 2014: by distance along the wall") \
    GW_ROW(seed_distance, REAL, 200.0, 1.0, 1000000.0, "", FRAME, "mm", "blur in the periphery against steps", "1000000", \
           "gaze_rule seed: distance from the ellipse on the wall over which voxels grow by one octree level")           \
    GW_ROW(gaze_footprint, REAL, 0.5, 0.0, 4.0, "", FRAME, "spacings", "blur in the periphery against steps",                 \
           "0 (rays as wide as the pixels they stand for, voxels by one pixel)",                                     \
           "least width of a ray, and what voxels go by, over the spacing that the viewer resolves there")             \
    GW_ROW(sample_block, CHOICE, 3, 0, 4, "1|2|4|8|16", FRAME, "px", "sharpness in the periphery against rays",            \
           "1 (a ray per pixel)", "largest square of pixels that shares one ray where the viewer cannot tell")          \
    GW_ROW(coarse_samples, CHOICE, 0, 0, 3, "1|2|4|8", FRAME, "rays", "aliasing in the periphery against rays", "8",     \
           "rays of a square of pixels that the viewer does not see sharp, at fixed places in it")                     \
    GW_ROW(reconstruction, CHOICE, 2, 0, 2, "bilinear|cubic|edge-aware", FRAME, "", "blurred and stepped silhouettes against time", \
           "bilinear", "how pixels are made of coarse samples: tents, sharper cubics, or cubics cut at silhouettes")     \
    GW_ROW(rate_blend, SWITCH, 1, 0, 1, "", FRAME, "", "visible borders between sample rates against blur", "off",      \
           "sharpness falls smoothly from one sample rate to the next")                                               \
    GW_ROW(edge_depth, REAL, 0.5, 0.01, 1.0, "", FRAME, "", "smeared silhouettes against stepped ones", "1 (depth is no edge)", \
           "sine of the angle to the surface beyond which the next sample lies on another one")                        \
    GW_ROW(edge_normal, REAL, 60.0, 1.0, 180.0, "", FRAME, "deg", "smeared creases against stepped ones",               \
           "180 (no crease is an edge)", "angle between the normals of two samples that makes an edge between them")  \
    GW_ROW(samples, CHOICE, 0, 0, 4, "1|2|4|8|16", FRAME, "rays", "jagged and shimmering edges against rays", "16",  \
           "rays of a pixel where the viewer sees it sharp, at fixed places in it")                                    \
    GW_ROW(accumulate, INTEGER, 1, 1, 256, "", FRAME, "samples", "jagged and shimmering edges against rays", "256",      \
           "samples of a still view that are added up, one a frame; 1: every frame stands for itself")                 \
    GW_ROW(strain, REAL, 1.0, 1.0, 16.0, "", FRAME, "times", "what the acuity model calls invisible against cost", "1",    \
           "coarser than viewers resolve: tau * strain^(1/4), gaze_margin / strain, acuity_slope and sample_block * strain") \
    GW_ROW(level_blend, SWITCH, 1, 0, 1, "", FRAME, "", "visible level steps against cost", "on",                      \
           "blend a voxel with its children where the footprint lies between two levels")                              \
    GW_ROW(leaf_blend, SWITCH, 1, 0, 1, "", FRAME, "", "visible triangle-to-voxel steps against cost", "on",           \
           "blend a leaf's triangles with its voxel while the footprint grows from half to all of the leaf")           \
    GW_ROW(voxel_slab, REAL, 0.06, 0.005, 0.25, "", FRAME, "sides", "gaps beside triangles against thickened edges",    \
           "tau 0", "half the thickness of the slab by which a flat voxel stands for its surface")                     \
    GW_ROW(voxel_flatness, REAL, 0.95, 0.2, 1.2, "", FRAME, "", "blur of curved voxels against gaps between them",       \
           "tau 0", "agreement of normals from which a voxel is a slab; 0.15 below it, it is a cloud; 1.2: always")     \
    GW_ROW(fold_agreement, REAL, 0.6, 0.0, 1.0, "", FRAME, "", "leaks of folded voxels against blur of thin plates",    \
           "tau 0", "a two-sided voxel whose normals agree less than this is a fold, not a plate, and never a slab")    \
    GW_ROW(separated_tau, REAL, 0.5, 0.0, 1.0, "", FRAME, "", "hidden surfaces in voxels against finer voxels", "0",      \
           "share of tau at which separated voxels stand for their contents; 0.5: one octree level later")             \
    GW_ROW(least_remainder, REAL, 0.00390625, 0.0001, 0.25, "", FRAME, "", "light from behind voxels against steps",     \
           "0.0001", "a ray ends when less than this share of it is left")                                              \
    GW_ROW(shadow_tau, REAL, 1.0, 0.0, 16.0, "", FRAME, "", "voxels in shadows against steps and tests", "0",            \
           "tau of shadow rays, as a multiple of the pixel's own; 0: every shadow ray ends at triangles")               \
    GW_ROW(near_light, INTEGER, 32, 0, 255, "", FRAME, "reaches", "light through joints of voxels against light on foliage", \
           "shadow_tau 0",                                                                                              \
           "nearer to a point light than this many heights of its voxels, what shows as a voxel has its shadow's ray start beyond them") \
    GW_ROW(shadow_samples, CHOICE, 1, 0, 2, "1|4|16", FRAME, "rays", "noise in penumbrae against shadow rays", "16, accumulated",       \
           "shadow rays to each light that has an extent, at places that differ from pixel to pixel")                     \
    GW_ROW(environment_lights, INTEGER, 8, 0, 64, "", FRAME, "lights", "shadows of skies and lamps in an environment against rays",   \
           "64, and brute-force integration over the environment",                                                      \
           "most lights that stand for what is brightest in an environment and cast shadows; 0: its light has none")      \
    GW_ROW(light_least, REAL, 0.0, 0.0, 1.0, "", FRAME, "radiance", "faint light of far lamps against rays", "0",                     \
           "the light of a light with a place ends where a white surface would reflect less of it than this; 0: nowhere") \
    GW_ROW(emissive_lights, INTEGER, 8, 0, 64, "", FRAME, "lights", "soft light of emissive surfaces against rays",                  \
           "64, and brute-force integration over emissive triangles",                                                   \
           "most lights that stand for emissive surfaces, each with the shape of its triangles; 0: they light nothing")  \
    GW_ROW(emissive_least, REAL, 0.001953125, 0.0, 1.0, "", FRAME, "radiance", "faint light of emissive surfaces against rays", "0",  \
           "the light of an emissive surface ends where a white surface would reflect less of it than this")             \
    GW_ROW(emissive_faintest, REAL, 0.5, 0.0, 1e9, "", FRAME, "radiance", "light of what glows faintly against rays", "0",             \
           "what emits less than this is seen to glow, but is no light; diffuse_bounce brings what it gives")             \
    GW_ROW(mirror_roughness, REAL, 0.02, 0.0, 0.25, "", FRAME, "", "rough metal shown as a mirror against rays", "0",      \
           "metal (metalness 1) of at most this roughness is a perfect mirror, whose reflections are traced")            \
    GW_ROW(glossy_roughness, REAL, 0.25, 0.0, 1.0, "", FRAME, "", "what nearly smooth surfaces reflect against rays", "1, accumulate 256", \
           "surfaces smoother than this reflect what stands round them, a ray a sample; others the light from everywhere; 0: none do") \
    GW_ROW(bounces, INTEGER, 4, 0, 8, "", FRAME, "", "mirrors in mirrors and what stands behind glass against rays", "8",   \
           "secondary rays one behind the other; what lies beyond the last shows the light from everywhere")            \
    GW_ROW(least_throughput, REAL, 0.015625, 0.0, 1.0, "", FRAME, "", "faint reflections against rays", "0",               \
           "a secondary ray is traced where 1 + tau times this share of a pixel may depend on it")                       \
    GW_ROW(occlusion_cones, CHOICE, 0, 0, 4, "0|1|3|5|6", FRAME, "cones", "flat light from everywhere against rays", "6, accumulate 256", \
           "cones about the normal that find what of the light from everywhere is covered by what stands near")         \
    GW_ROW(occlusion_distance, REAL, 0.1, 0.001, 2.0, "", FRAME, "cube sides", "light from everywhere in closed rooms against steps", "2", \
           "what stands farther away covers nothing, and half of that fully; the octree's cube has side 1")             \
    GW_ROW(diffuse_bounce, CHOICE, 0, 0, 2, "off|on|all", FRAME, "", "colours that are not passed on against shadow rays", "all", \
           "what the cones of occlusion_cones meet is lit, and lights in turn what they start from, once; all: with what goes on from there, by estimate") \
    GW_ROW(exposure, REAL, 0.0, -24.0, 24.0, "auto", FRAME, "stops", "detail in the dark against detail in the light", "0", \
           "light is multiplied by 2 to the power of this; auto: so that the mean of the picture comes to exposure_key") \
    GW_ROW(tone, CHOICE, 0, 0, 1, "linear|filmic", FRAME, "", "highlights that are cut off against colours as they are", "linear", \
           "curve from light to the screen: cut off at 1, or a shoulder for what is brighter (Narkowicz 2016)")          \
    GW_ROW(dither, SWITCH, 0, 0, 1, "", FRAME, "", "bands in smooth shades against noise of half a code", "off",            \
           "a fixed pattern on the wall decides which way a pixel is rounded to 8 bits")                                 \
    GW_ROW(exposure_key, REAL, 0.18, 0.01, 1.0, "", TRACK, "", "a dark picture against a pale one", "0.18",                \
           "exposure=auto: what the mean of the picture's log-luminance is brought to")                                  \
    GW_ROW(exposure_speed, REAL, 3.0, 0.01, 1000.0, "", TRACK, "stops/s", "eyes that wait against a picture that pumps", "1000", \
           "exposure=auto: most by which exposure moves in a second of the frames' time")                                \
    GW_ROW(head_filter, CHOICE, 0, 0, 2, "none|one-euro|kalman", TRACK, "", "shaking heads against late ones", "none",        \
           "how the eyes' places are smoothed; one-euro and kalman also steady the heads' turns")                        \
    GW_ROW(head_cutoff, REAL, 2.0, 0.05, 1000.0, "", TRACK, "Hz", "shaking heads against late ones", "1000",              \
           "one-euro: cutoff of a head at rest")                                                                        \
    GW_ROW(head_cutoff_growth, REAL, 30.0, 0.0, 10000.0, "", TRACK, "Hz s/m", "late heads against shaking ones", "10000",  \
           "one-euro: growth of the cutoff per m/s of speed")                                                           \
    GW_ROW(head_noise, REAL, 0.5, 0.001, 1000.0, "", TRACK, "mm", "shaking heads against late ones", "0.001",             \
           "kalman: standard deviation of the tracker's noise along an axis")                                            \
    GW_ROW(head_acceleration, REAL, 3.0, 0.01, 1000.0, "", TRACK, "m/s^2", "late heads against shaking ones", "1000",      \
           "kalman: usual acceleration of heads")                                                                       \
    GW_ROW(turn_cutoff, REAL, 2.0, 0.05, 1000.0, "", TRACK, "Hz", "shaking turns against late ones", "1000",              \
           "one-euro of the heads' turns: cutoff at rest")                                                              \
    GW_ROW(turn_cutoff_growth, REAL, 0.3, 0.0, 1000.0, "", TRACK, "Hz s/deg", "late turns against shaking ones", "1000",   \
           "one-euro of the heads' turns: growth of the cutoff per deg/s of speed")                                      \
    GW_ROW(gaze_filter, CHOICE, 0, 0, 1, "none|one-euro", TRACK, "", "shaking gazes against late ones", "none",           \
           "how gazes are smoothed in fixations and pursuit; never in a saccade")                                        \
    GW_ROW(gaze_cutoff, REAL, 3.0, 0.05, 1000.0, "", TRACK, "Hz", "shaking gazes against late ones", "1000",              \
           "one-euro of gazes: cutoff at rest")                                                                         \
    GW_ROW(gaze_cutoff_growth, REAL, 0.1, 0.0, 1000.0, "", TRACK, "Hz s/deg", "late gazes against shaking ones", "1000",   \
           "one-euro of gazes: growth of the cutoff per deg/s of speed")                                                 \
    GW_ROW(saccade_speed, REAL, 70.0, 0.0, 10000.0, "", TRACK, "deg/s", "saccades that are missed against noise taken for one", \
           "0 (none is looked for)", "a gaze that moves as fast is a saccade, until it is half as fast")                 \
    GW_ROW(saccade_growth_limit, REAL, 15.0, 0.0, 90.0, "", TRACK, "deg", "late gazes in saccades against cost", "90",        \
           "most that a saccade that goes on adds to each half-angle of the ellipsoid")                                  \
    GW_ROW(gaze_prediction, SWITCH, 0, 0, 1, "", TRACK, "", "late gazes in pursuit against gazes that overshoot", "off",     \
           "gazes that follow something are predicted to when the frame is seen; never in a saccade")                    \
    GW_ROW(prediction, SWITCH, 1, 0, 1, "", TRACK, "", "late eyes against eyes that overshoot", "off",                     \
           "heads are predicted, at their speed and turn, to when the frame is seen")                                    \
    GW_ROW(prediction_limit, REAL, 0.1, 0.0, 0.5, "", TRACK, "s", "late eyes against eyes that overshoot", "0",            \
           "longest time by which heads and gazes are predicted, and never beyond hold_time")                                      \
    GW_ROW(hold_time, REAL, 0.1, 0.02, 10.0, "", TRACK, "s", "an eye that stands against one that leaves", "10",           \
           "a sensor that is silent longer than this, and than 3 of its periods, is lost")                               \
    GW_ROW(glide_speed, REAL, 1.0, 0.05, 1.2, "", TRACK, "m/s", "a wrong eye against one that moves by itself", "1.2",     \
           "speed at which the eye leaves a lost head for the neutral place, and comes back")                            \
    GW_ROW(gaze_fade, REAL, 0.4, 0.0, 10.0, "", TRACK, "s", "late gazes against cost", "10",                               \
           "the confidence of a lost gaze falls from 1 to 0 over this time")                                             \
    GW_ROW(added_latency, REAL, 0.0, 0.0, 5.0, "", TRACK, "s", "for studies: samples reach us this much later", "0",        \
           "delay of every sample on its way, as if the tracker or its network were slower")                             \
    GW_ROW(texture_filter, CHOICE, 2, 0, 2, "nearest|bilinear|trilinear", FRAME, "", "texture aliasing against fetches", \
           "trilinear", "how base-colour textures are read at the ray's footprint")                                    \
    GW_ROW(triangle_precision, CHOICE, 0, 0, 2, "float|double|ordered", FRAME, "",                                      \
           "rounding at shared edges against time", "double",                                                          \
           "edge products of the triangle test: double takes those that are exactly zero again; ordered is watertight even where " \
           "precise does not hold (inspect --device)")
/* clang-format on */

typedef struct gw_settings {
#define GW_FIELD_REAL(field) double field
#define GW_FIELD_INTEGER(field) int32_t field
#define GW_FIELD_SWITCH(field) int32_t field
#define GW_FIELD_CHOICE(field) int32_t field
#define GW_ROW_FIELD(field, kind, ...) GW_FIELD_##kind(field);
    GW_SETTINGS_TABLE(GW_ROW_FIELD)
#undef GW_ROW_FIELD
#undef GW_FIELD_REAL
#undef GW_FIELD_INTEGER
#undef GW_FIELD_SWITCH
#undef GW_FIELD_CHOICE
} gw_settings;

typedef enum gw_setting_kind {
    GW_SETTING_REAL,
    GW_SETTING_INTEGER,
    GW_SETTING_SWITCH,
    GW_SETTING_CHOICE
} gw_setting_kind;
typedef enum gw_setting_stage { GW_SETTING_BUILD, GW_SETTING_FRAME, GW_SETTING_TRACK } gw_setting_stage;
#define GW_SETTING_AUTO ((double)INFINITY)
enum { GW_TONE_LINEAR, GW_TONE_FILMIC };
enum { GW_BOUNCE_NONE, GW_BOUNCE_ONCE, GW_BOUNCE_ALL };
enum { GW_HEAD_NONE, GW_HEAD_ONE_EURO, GW_HEAD_KALMAN };
enum { GW_PAYLOAD_AREA, GW_PAYLOAD_SEED };
enum { GW_GEOMETRY_HYBRID, GW_GEOMETRY_TRIANGLES, GW_GEOMETRY_VOXELS };
enum { GW_FILTER_NEAREST, GW_FILTER_BILINEAR, GW_FILTER_TRILINEAR };
enum { GW_GAZE_ACUITY, GW_GAZE_SEED };
enum { GW_RECONSTRUCTION_BILINEAR, GW_RECONSTRUCTION_CUBIC, GW_RECONSTRUCTION_EDGE_AWARE };
enum { GW_PRECISION_FLOAT, GW_PRECISION_DOUBLE, GW_PRECISION_ORDERED };

typedef struct gw_setting_row {
    const char *name;
    gw_setting_kind kind;
    gw_setting_stage stage;
    double initial, minimum, maximum;
    const char *choices, *unit, *trades, *reference, *help;
    size_t offset; /* of the field in gw_settings */
} gw_setting_row;

extern const gw_setting_row gw_setting_rows[];
extern const size_t gw_setting_count;

void gw_settings_init(gw_settings *settings); /* every field at its default */

/* "name=value"; GW_BAD_INPUT names the row's range or choices, or the nearest known name. */
gw_code gw_settings_assign(gw_settings *settings, const char *assignment, gw_error *error);

double gw_setting_value(const gw_settings *settings, const gw_setting_row *row);
void gw_setting_store(gw_settings *settings, const gw_setting_row *row, double value); /* in its range */
/* The value as --set takes it: "1", "0.022", "hybrid", "on". */
void gw_setting_text(const gw_settings *settings, const gw_setting_row *row, char text[64]);

#endif

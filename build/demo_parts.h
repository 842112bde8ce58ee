/* Inside of the demo scene: the mesh that its parts are added to, noise, textures and materials.
 *
 * Everything is made from integers and + - * / sqrt in double (base/portable_math.h), so it has the same bits
 * on every machine. Errors stick to the mesh: the first one is kept, later calls do nothing, demo_scene.c
 * asks once at the end. Used only by build/demo_*.c. Lengths in metres, y up. */
#ifndef GW_BUILD_DEMO_PARTS_H
#define GW_BUILD_DEMO_PARTS_H

#include "base/image.h"
#include "base/status.h"
#include "build/scene.h"

#include <stddef.h>
#include <stdint.h>

typedef struct demo_point {
    double x, y, z;
} demo_point;

demo_point demo_add(demo_point a, demo_point b);
demo_point demo_subtract(demo_point a, demo_point b);
demo_point demo_scaled(demo_point a, double factor);
demo_point demo_toward(demo_point a, demo_point b, double t); /* a at 0, b at 1 */
double demo_dot(demo_point a, demo_point b);
demo_point demo_cross(demo_point a, demo_point b);
demo_point demo_unit(demo_point a); /* (0,1,0) for a zero vector */

double demo_clamp(double value, double low, double high);
double demo_smooth(double low, double high, double value); /* 0 below low, 1 above high, smooth between */

/* Integer hash noise. */
uint32_t demo_hash(uint32_t a, uint32_t b, uint32_t c);
/* The next of a sequence, 0 <= value < 1; *state is any number. */
double demo_random(uint32_t *state);
/* Smooth value noise 0..1 that repeats after period lattice steps in both directions. */
double demo_noise(double x, double y, uint32_t period, uint32_t seed);
/* The sum of octaves of noise, each twice as fine and half as strong, 0..1. */
double demo_fractal(double x, double y, uint32_t period, int octaves, uint32_t seed);

typedef enum demo_material {
    DEMO_FLOOR,
    DEMO_SUNLIT, /* the floor where the sun comes through a window */
    DEMO_ASHLAR,
    DEMO_PLASTER,
    DEMO_MARBLE,
    DEMO_VAULT,
    DEMO_TRIM,
    DEMO_WOOD,
    DEMO_CARPET,
    DEMO_LANDSCAPE,
    DEMO_STATUE,
    DEMO_PEDESTAL,
    DEMO_TERRACOTTA,
    DEMO_SOIL,
    DEMO_BARK,
    DEMO_LEAF,
    DEMO_IVY,
    DEMO_ORANGE,
    DEMO_MATERIALS
} demo_material;

typedef struct demo_vertex {
    demo_point position;
    demo_point normal; /* need not be unit */
    double u, v;
    double shade; /* 0..1: how much of the surroundings' light comes here; becomes the vertex colour */
} demo_vertex;

typedef struct demo_mesh {
    double (*positions)[3];
    float (*normals)[3];
    float (*texcoords)[2];
    uint8_t (*colors)[4];
    size_t vertex_count, vertex_capacity[4];
    uint32_t (*triangles)[3];
    uint32_t *materials;
    size_t triangle_count, triangle_capacity[2];
    gw_code code; /* GW_OK until something failed */
    gw_error *error;
} demo_mesh;

uint32_t demo_add_vertex(demo_mesh *mesh, const demo_vertex *vertex);
void demo_add_triangle(demo_mesh *mesh, uint32_t a, uint32_t b, uint32_t c, demo_material material);

/* A flat quadrilateral a b c d, counter-clockwise seen from its front, cut into columns x rows cells. Texture
 * coordinates are lengths along ab and ad over `period` metres, counted from the scene's axes, so neighbours
 * join. shade may be NULL (1 everywhere). */
typedef double (*demo_shader)(demo_point position);
void demo_quad(demo_mesh *mesh, demo_point a, demo_point b, demo_point c, demo_point d, int columns, int rows,
               double period, demo_shader shade, demo_material material);
/* Axis-parallel box, each face one quadrilateral; no underside at or below y = 0. */
void demo_box(demo_mesh *mesh, demo_point low, demo_point high, double period, demo_shader shade,
              demo_material material);

/* Grid of (columns+1) x (rows+1) vertices of a surface, u and v in 0..1; the front is where dP/du x dP/dv
 * points. Normals are taken from the cells around each vertex, across the seam where the surface is closed in
 * u or v. The surface function sets position, u, v and shade. */
typedef void (*demo_surface)(const void *context, double u, double v, demo_vertex *out);
void demo_grid(demo_mesh *mesh, int columns, int rows, int closed_u, int closed_v, demo_surface surface,
               const void *context, demo_material material);

/* Surface of revolution about the vertical through centre: profile points (radius, height) upwards; sharp
 * where the same point comes twice. flutes > 0 carves that many flutes of relative depth `flute_depth` into
 * it. */
typedef struct demo_profile {
    double radius, height;
} demo_profile;
typedef struct demo_lathe_options {
    int sides;
    int flutes;
    double flute_depth;
    double turns;                 /* texture repeats around */
    double period;                /* m of height per texture repeat */
    double shade_low, shade_high; /* shade at the foot and at the top */
} demo_lathe_options;
void demo_lathe(demo_mesh *mesh, demo_point centre, const demo_profile *profile, int count,
                const demo_lathe_options *options, demo_material material);

/* Tapered tube along points, `sides` round, open at the ends. */
void demo_tube(demo_mesh *mesh, const demo_point *points, const double *radii, int count, int sides,
               double shade, demo_material material);

/* The parts. */
void demo_hall(demo_mesh *mesh);     /* floor, arcades, vault, end wall, steps */
void demo_columns(demo_mesh *mesh);  /* columns of the arcades */
void demo_statue(demo_mesh *mesh);   /* the knot on its pedestal; the knot is closed */
void demo_trees(demo_mesh *mesh);    /* orange trees in pots */
void demo_climbers(demo_mesh *mesh); /* ivy */

/* Where things stand, shared by the parts and by what darkens the floor under them. */
enum { DEMO_BAYS = 5, DEMO_TREES = 5 };
#define DEMO_NEAR (-2.2)          /* z where the hall begins, behind the wall's plane at -1.8 */
#define DEMO_FAR (-17.2)          /* z of the end wall */
#define DEMO_BAY 2.5              /* m from column to column */
#define DEMO_FIRST_COLUMN (-4.2)  /* z */
#define DEMO_ARCADE 2.5           /* x of the arcades' middle */
#define DEMO_THICKNESS 0.22       /* half of the arcades' thickness */
#define DEMO_SPRING 2.45          /* y where the arches begin */
#define DEMO_CORNICE 3.85         /* y of the cornice's lower edge */
#define DEMO_VAULT_SPRING 4.1     /* y where the vault begins */
extern const demo_point demo_sun; /* unit: where the light travels */
extern const demo_point demo_statue_foot;
typedef struct demo_tree {
    demo_point foot;
    double scale;
    int twigs, fruits;
} demo_tree;
extern const demo_tree demo_tree_list[DEMO_TREES];

/* Fills materials and textures of the scene. */
gw_code demo_make_materials(gw_scene *scene, gw_error *error);
/* Makes one texture by its index; demo_textures.c. */
enum {
    DEMO_TEXTURE_FLOOR,
    DEMO_TEXTURE_ASHLAR,
    DEMO_TEXTURE_PLASTER,
    DEMO_TEXTURE_MARBLE,
    DEMO_TEXTURE_VAULT,
    DEMO_TEXTURE_WOOD,
    DEMO_TEXTURE_CARPET,
    DEMO_TEXTURE_LANDSCAPE,
    DEMO_TEXTURE_PEDESTAL,
    DEMO_TEXTURE_TERRACOTTA,
    DEMO_TEXTURE_LEAF,
    DEMO_TEXTURES
};
gw_code demo_make_texture(int index, gw_texture *out, gw_error *error);

#endif

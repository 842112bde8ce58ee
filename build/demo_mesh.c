#include "base/memory.h"
#include "base/portable_math.h"
#include "build/demo_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

demo_point demo_add(demo_point a, demo_point b) {
    return (demo_point){a.x + b.x, a.y + b.y, a.z + b.z};
}

demo_point demo_subtract(demo_point a, demo_point b) {
    return (demo_point){a.x - b.x, a.y - b.y, a.z - b.z};
}

demo_point demo_scaled(demo_point a, double factor) {
    return (demo_point){a.x * factor, a.y * factor, a.z * factor};
}

demo_point demo_toward(demo_point a, demo_point b, double t) {
    return demo_add(demo_scaled(a, 1.0 - t), demo_scaled(b, t));
}

double demo_dot(demo_point a, demo_point b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

demo_point demo_cross(demo_point a, demo_point b) {
    return (demo_point){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

demo_point demo_unit(demo_point a) {
    double length = sqrt(demo_dot(a, a));
    return length > 0.0 ? demo_scaled(a, 1.0 / length) : (demo_point){0.0, 1.0, 0.0};
}

double demo_clamp(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

double demo_smooth(double low, double high, double value) {
    double t = demo_clamp((value - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

static int grow(demo_mesh *mesh, void **array, size_t *capacity, size_t needed, size_t size) {
    if (mesh->code == GW_OK)
        mesh->code = gw_grow(array, capacity, needed, size, "demo scene", mesh->error);
    return mesh->code == GW_OK;
}

uint32_t demo_add_vertex(demo_mesh *mesh, const demo_vertex *vertex) {
    size_t index = mesh->vertex_count;
    void *positions = mesh->positions, *normals = mesh->normals, *texcoords = mesh->texcoords,
         *colors = mesh->colors;
    int room = grow(mesh, &positions, &mesh->vertex_capacity[0], index + 1, sizeof *mesh->positions);
    room = room && grow(mesh, &normals, &mesh->vertex_capacity[1], index + 1, sizeof *mesh->normals);
    room = room && grow(mesh, &texcoords, &mesh->vertex_capacity[2], index + 1, sizeof *mesh->texcoords);
    room = room && grow(mesh, &colors, &mesh->vertex_capacity[3], index + 1, sizeof *mesh->colors);
    mesh->positions = positions;
    mesh->normals = normals;
    mesh->texcoords = texcoords;
    mesh->colors = colors;
    if (!room)
        return 0;
    demo_point normal = demo_unit(vertex->normal);
    uint8_t shade = (uint8_t)(demo_clamp(vertex->shade, 0.0, 1.0) * 255.0 + 0.5);
    memcpy(mesh->positions[index], &(double[3]){vertex->position.x, vertex->position.y, vertex->position.z},
           sizeof *mesh->positions);
    memcpy(mesh->normals[index], &(float[3]){(float)normal.x, (float)normal.y, (float)normal.z},
           sizeof *mesh->normals);
    memcpy(mesh->texcoords[index], &(float[2]){(float)vertex->u, (float)vertex->v}, sizeof *mesh->texcoords);
    memcpy(mesh->colors[index], &(uint8_t[4]){shade, shade, shade, 255}, sizeof *mesh->colors);
    mesh->vertex_count++;
    return (uint32_t)index;
}

void demo_add_triangle(demo_mesh *mesh, uint32_t a, uint32_t b, uint32_t c, demo_material material) {
    size_t index = mesh->triangle_count;
    void *triangles = mesh->triangles, *materials = mesh->materials;
    int room = grow(mesh, &triangles, &mesh->triangle_capacity[0], index + 1, sizeof *mesh->triangles);
    room = room && grow(mesh, &materials, &mesh->triangle_capacity[1], index + 1, sizeof *mesh->materials);
    mesh->triangles = triangles;
    mesh->materials = materials;
    if (!room)
        return;
    memcpy(mesh->triangles[index], &(uint32_t[3]){a, b, c}, sizeof *mesh->triangles);
    mesh->materials[index] = (uint32_t)material;
    mesh->triangle_count++;
}

void demo_quad(demo_mesh *mesh, demo_point a, demo_point b, demo_point c, demo_point d, int columns, int rows,
               double period, demo_shader shade, demo_material material) {
    demo_point right = demo_unit(demo_subtract(b, a)), up = demo_unit(demo_subtract(d, a));
    demo_vertex vertex = {.normal = demo_cross(right, up)};
    uint32_t first = (uint32_t)mesh->vertex_count;
    for (int row = 0; row <= rows; row++)
        for (int column = 0; column <= columns; column++) {
            double s = (double)column / columns, t = (double)row / rows;
            vertex.position = demo_toward(demo_toward(a, b, s), demo_toward(d, c, s), t);
            vertex.u = demo_dot(vertex.position, right) / period;
            vertex.v = -demo_dot(vertex.position, up) / period;
            vertex.shade = shade != NULL ? shade(vertex.position) : 1.0;
            demo_add_vertex(mesh, &vertex);
        }
    uint32_t stride = (uint32_t)columns + 1;
    for (uint32_t row = 0; row < (uint32_t)rows; row++)
        for (uint32_t column = 0; column < (uint32_t)columns; column++) {
            uint32_t corner = first + row * stride + column;
            demo_add_triangle(mesh, corner, corner + 1, corner + stride + 1, material);
            demo_add_triangle(mesh, corner, corner + stride + 1, corner + stride, material);
        }
}

void demo_box(demo_mesh *mesh, demo_point low, demo_point high, double period, demo_shader shade,
              demo_material material) {
    demo_point p[8];
    for (int i = 0; i < 8; i++)
        p[i] = (demo_point){i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
    static const int faces[6][4] = {{4, 5, 7, 6}, {5, 1, 3, 7}, {1, 0, 2, 3},
                                    {0, 4, 6, 2}, {6, 7, 3, 2}, {0, 1, 5, 4}};
    int count = low.y > 0.0 ? 6 : 5; /* nobody sees the underside of what stands on the floor */
    for (int i = 0; i < count; i++)
        demo_quad(mesh, p[faces[i][0]], p[faces[i][1]], p[faces[i][2]], p[faces[i][3]], 1, 1, period, shade,
                  material);
}

/* Index of a grid's vertex; a closed direction wraps to the twin that has the same position. */
static size_t grid_index(int column, int row, int columns, int rows, int closed_u, int closed_v) {
    if (closed_u)
        column = (column + columns) % columns;
    if (closed_v)
        row = (row + rows) % rows;
    return (size_t)row * ((size_t)columns + 1) + (size_t)column;
}

static demo_point position_at(const demo_mesh *mesh, size_t index) {
    return (demo_point){mesh->positions[index][0], mesh->positions[index][1], mesh->positions[index][2]};
}

/* Central differences, one-sided at open borders, exact across closed seams. */
static demo_point grid_normal(const demo_mesh *mesh, size_t first, int column, int row, const int size[2],
                              const int closed[2]) {
    int left = column > 0 || closed[0] ? column - 1 : column,
        right = column < size[0] || closed[0] ? column + 1 : column;
    int below = row > 0 || closed[1] ? row - 1 : row, above = row < size[1] || closed[1] ? row + 1 : row;
    demo_point ends[4];
    const int at[4][2] = {{left, row}, {right, row}, {column, below}, {column, above}};
    for (int i = 0; i < 4; i++)
        ends[i] =
            position_at(mesh, first + grid_index(at[i][0], at[i][1], size[0], size[1], closed[0], closed[1]));
    return demo_unit(demo_cross(demo_subtract(ends[1], ends[0]), demo_subtract(ends[3], ends[2])));
}

void demo_grid(demo_mesh *mesh, int columns, int rows, int closed_u, int closed_v, demo_surface surface,
               const void *context, demo_material material) {
    const int size[2] = {columns, rows}, closed[2] = {closed_u, closed_v};
    size_t first = mesh->vertex_count;
    for (int row = 0; row <= rows; row++)
        for (int column = 0; column <= columns; column++) {
            demo_vertex vertex = {.shade = 1.0};
            surface(context, (double)column / columns, (double)row / rows, &vertex);
            size_t twin = first + grid_index(column, row, columns, rows, closed_u, closed_v);
            if (twin < mesh->vertex_count) /* the seam: the same bits, so that the surface is closed */
                vertex.position = position_at(mesh, twin);
            demo_add_vertex(mesh, &vertex);
        }
    if (mesh->code != GW_OK)
        return;
    for (int row = 0; row <= rows; row++)
        for (int column = 0; column <= columns; column++) {
            demo_point n = grid_normal(mesh, first, column, row, size, closed);
            float *normal = mesh->normals[first + (size_t)row * ((size_t)columns + 1) + (size_t)column];
            normal[0] = (float)n.x;
            normal[1] = (float)n.y;
            normal[2] = (float)n.z;
        }
    uint32_t stride = (uint32_t)columns + 1;
    for (uint32_t row = 0; row < (uint32_t)rows; row++)
        for (uint32_t column = 0; column < (uint32_t)columns; column++) {
            uint32_t corner = (uint32_t)first + row * stride + column;
            demo_add_triangle(mesh, corner, corner + 1, corner + stride + 1, material);
            demo_add_triangle(mesh, corner, corner + stride + 1, corner + stride, material);
        }
}

typedef struct lathe_row {
    demo_point centre;
    demo_profile point;
    demo_point slope; /* radius and height of the outward normal */
    double shade;
    const demo_lathe_options *options;
} lathe_row;

static uint32_t add_lathe_row(demo_mesh *mesh, const lathe_row *row) {
    const demo_lathe_options *o = row->options;
    uint32_t first = (uint32_t)mesh->vertex_count;
    for (int i = 0; i <= o->sides; i++) {
        double turn = 2.0 * GW_PI * (i % o->sides) / o->sides;
        double radius = row->point.radius, lean = 0.0;
        if (o->flutes > 0) { /* hollows with sharp ridges between them */
            double phase = 0.5 * o->flutes * turn, wave = gw_sin(phase), sign = wave < 0.0 ? -1.0 : 1.0;
            radius *= 1.0 - o->flute_depth * sign * wave;
            lean = o->flute_depth * 0.5 * o->flutes * gw_cos(phase) * sign;
        }
        double c = gw_cos(turn), s = gw_sin(turn);
        demo_vertex vertex = {.shade = row->shade};
        vertex.position = (demo_point){row->centre.x + radius * c, row->centre.y + row->point.height,
                                       row->centre.z - radius * s};
        vertex.normal =
            (demo_point){row->slope.x * (c - lean * s), row->slope.y, -row->slope.x * (s + lean * c)};
        vertex.u = o->turns * i / o->sides;
        vertex.v = -row->point.height / o->period;
        demo_add_vertex(mesh, &vertex);
    }
    return first;
}

void demo_lathe(demo_mesh *mesh, demo_point centre, const demo_profile *profile, int count,
                const demo_lathe_options *options, demo_material material) {
    double foot = profile[0].height, rise = profile[count - 1].height - foot;
    uint32_t before = 0;
    int have_before = 0;
    for (int i = 0; i < count; i++) {
        int sharp_below = i == 0 || (profile[i].radius == profile[i - 1].radius &&
                                     profile[i].height == profile[i - 1].height);
        int sharp_above = i == count - 1 || (profile[i].radius == profile[i + 1].radius &&
                                             profile[i].height == profile[i + 1].height);
        int low = sharp_below ? i : i - 1, high = sharp_above ? i : i + 1;
        lathe_row row = {.centre = centre, .point = profile[i], .options = options};
        row.slope = demo_unit((demo_point){profile[high].height - profile[low].height,
                                           profile[low].radius - profile[high].radius, 0.0});
        row.shade = options->shade_low + (options->shade_high - options->shade_low) *
                                             (rise != 0.0 ? (profile[i].height - foot) / rise : 1.0);
        uint32_t now = add_lathe_row(mesh, &row);
        if (have_before && !(sharp_below && i > 0))
            for (uint32_t side = 0; side < (uint32_t)options->sides; side++) {
                if (profile[i - 1].radius > 0.0)
                    demo_add_triangle(mesh, before + side, before + side + 1, now + side, material);
                if (profile[i].radius > 0.0)
                    demo_add_triangle(mesh, before + side + 1, now + side + 1, now + side, material);
            }
        before = now;
        have_before = 1;
    }
}

void demo_tube(demo_mesh *mesh, const demo_point *points, const double *radii, int count, int sides,
               double shade, demo_material material) {
    uint32_t first = (uint32_t)mesh->vertex_count;
    demo_point side = {0.31, 0.17, 0.93}; /* carried along, so that the tube does not twist */
    double length = 0.0;
    for (int i = 0; i < count; i++) {
        demo_point along =
            demo_unit(demo_subtract(points[i + 1 < count ? i + 1 : i], points[i > 0 ? i - 1 : i]));
        side = demo_unit(demo_subtract(side, demo_scaled(along, demo_dot(side, along))));
        demo_point up = demo_cross(along, side);
        if (i > 0)
            length += sqrt(
                demo_dot(demo_subtract(points[i], points[i - 1]), demo_subtract(points[i], points[i - 1])));
        for (int k = 0; k <= sides; k++) {
            double turn = 2.0 * GW_PI * (k % sides) / sides;
            demo_vertex vertex = {.shade = shade, .u = (double)k / sides, .v = length * 4.0};
            vertex.normal = demo_add(demo_scaled(side, gw_cos(turn)), demo_scaled(up, gw_sin(turn)));
            vertex.position = demo_add(points[i], demo_scaled(vertex.normal, radii[i]));
            demo_add_vertex(mesh, &vertex);
        }
    }
    uint32_t stride = (uint32_t)sides + 1;
    for (uint32_t i = 0; i + 1 < (uint32_t)count; i++)
        for (uint32_t k = 0; k < (uint32_t)sides; k++) {
            uint32_t corner = first + i * stride + k;
            demo_add_triangle(mesh, corner, corner + 1, corner + stride + 1, material);
            demo_add_triangle(mesh, corner, corner + stride + 1, corner + stride, material);
        }
}

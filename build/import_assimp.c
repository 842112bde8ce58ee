/* What assimp read, flattened: one list of vertices in double precision and one of triangles, lights and
 * cameras placed by their nodes. Runs in the import child. */
#include "build/import_internal.h"

#include "base/memory.h"
#include "build/matrix.h"
#include "build/tangent.h"

#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAXIMUM_NODE_DEPTH = 2000 };

typedef struct converter {
    const struct aiScene *read;
    gw_model_format format;
    const gw_import_files *files;
    gw_source_model *model;
    uint64_t vertices, triangles; /* counted in the first walk, placed so far in the second */
    uint64_t other_primitives;
    uint32_t placed_lights, placed_cameras;
    uint64_t bad_tangents;
    int normals, tangents, texcoords, second_texcoords, colors; /* some mesh has them */
    size_t span_capacity;
    int counting;
    gw_error *error;
} converter;

typedef struct matrix {
    double m[3][4];
} matrix;

static matrix multiply(const matrix *a, const struct aiMatrix4x4 *b) {
    const double rows[3][4] = {
        {b->a1, b->a2, b->a3, b->a4}, {b->b1, b->b2, b->b3, b->b4}, {b->c1, b->c2, b->c3, b->c4}};
    matrix product;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            product.m[i][k] = a->m[i][0] * rows[0][k] + a->m[i][1] * rows[1][k] + a->m[i][2] * rows[2][k] +
                              (k == 3 ? a->m[i][3] : 0.0);
    return product;
}

static void place_point(const matrix *a, const struct aiVector3D *p, double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] =
            a->m[i][0] * (double)p->x + a->m[i][1] * (double)p->y + a->m[i][2] * (double)p->z + a->m[i][3];
}

static void place_normal(const double cofactors[3][3], const struct aiVector3D *n, float out[3]) {
    const float normal[3] = {(float)n->x, (float)n->y, (float)n->z};
    gw_matrix_normal(cofactors, normal, out);
}

static int place_direction(const matrix *a, const struct aiVector3D *d, double out[3]) {
    double length = 0.0;
    for (int i = 0; i < 3; i++) {
        out[i] = a->m[i][0] * (double)d->x + a->m[i][1] * (double)d->y + a->m[i][2] * (double)d->z;
        length += out[i] * out[i];
    }
    length = sqrt(length);
    for (int i = 0; i < 3; i++)
        out[i] /= length;
    return isfinite(length) && length > 0.0;
}

/* --- meshes --- */

/* Which of assimp's sets become the first and the second of the scene, -1: none. */
static void texcoord_sets(const converter *self, const struct aiMesh *mesh, int32_t sets[2]) {
    const gw_import_files *files = self->files;
    sets[0] = 0;
    sets[1] = -1;
    if (self->format != GW_FORMAT_GLTF || mesh->mMaterialIndex >= self->read->mNumMaterials)
        return;
    const int32_t index = gw_import_material_index(self->read->mMaterials[mesh->mMaterialIndex]);
    if (index >= 0 && (size_t)index < files->texcoord_set_count)
        memcpy(sets, files->texcoord_sets[index], 2 * sizeof *sets);
    if (sets[0] < 0)
        sets[0] = 0;
}

/* Of other formats they would be made up. */
static int has_tangents(const converter *self, const struct aiMesh *mesh) {
    return self->format == GW_FORMAT_GLTF && mesh->mNormals && mesh->mTangents && mesh->mBitangents;
}

static void count_mesh(converter *self, const struct aiMesh *mesh) {
    self->vertices += mesh->mNumVertices;
    for (unsigned f = 0; f < mesh->mNumFaces; f++) {
        self->triangles += mesh->mFaces[f].mNumIndices == 3;
        self->other_primitives += mesh->mFaces[f].mNumIndices != 3;
    }
    if (mesh->mNumFaces == 0)
        self->other_primitives += mesh->mNumVertices; /* a cloud of points */
    self->normals |= mesh->mNormals != NULL && self->format != GW_FORMAT_STL;
    self->tangents |= has_tangents(self, mesh);
    int32_t sets[2];
    texcoord_sets(self, mesh, sets);
    self->texcoords |= sets[0] >= 0 && mesh->mTextureCoords[sets[0]] != NULL;
    self->second_texcoords |= sets[1] >= 0;
    self->colors |= mesh->mColors[0] != NULL;
}

static void put_texcoords(const struct aiMesh *mesh, int32_t set, float *out) {
    const struct aiVector3D *texcoords = set >= 0 ? mesh->mTextureCoords[set] : NULL;
    for (unsigned v = 0; texcoords && v < mesh->mNumVertices; v++) {
        out[(size_t)v * 2] = (float)texcoords[v].x;
        out[(size_t)v * 2 + 1] = (float)(1.0 - (double)texcoords[v].y); /* assimp's v points up */
    }
}

/* assimp has the other axis, cross(normal, tangent) times the file's sign, in place of the sign. */
static uint32_t tangent_of(const struct aiVector3D *n, const struct aiVector3D *t,
                           const struct aiVector3D *b) {
    const double normal[3] = {(double)n->x, (double)n->y, (double)n->z},
                 tangent[3] = {(double)t->x, (double)t->y, (double)t->z},
                 other[3] = {(double)b->x, (double)b->y, (double)b->z};
    double side = 0.0;
    for (int i = 0; i < 3; i++) {
        const int k = (i + 1) % 3, l = (i + 2) % 3;
        side += (normal[k] * tangent[l] - normal[l] * tangent[k]) * other[i];
    }
    return gw_tangent_pack(tangent, side);
}

static void put_tangents(converter *self, const struct aiMesh *mesh, const matrix *place, uint32_t *out) {
    for (unsigned v = 0; v < mesh->mNumVertices; v++) {
        out[v] = gw_tangent_transform(
            place->m, tangent_of(&mesh->mNormals[v], &mesh->mTangents[v], &mesh->mBitangents[v]));
        self->bad_tangents += out[v] == 0;
    }
}

/* glTF colours are linear; those of scans and OBJ files are meant for display. */
static void put_colors(const converter *self, const struct aiMesh *mesh, uint8_t *out) {
    const struct aiColor4D *colors = mesh->mColors[0];
    for (unsigned v = 0; v < mesh->mNumVertices; v++) {
        float channels[4] = {1, 1, 1, 1};
        if (colors)
            memcpy(channels,
                   (const float[4]){(float)colors[v].r, (float)colors[v].g, (float)colors[v].b,
                                    (float)colors[v].a},
                   sizeof channels);
        for (int i = 0; i < 4; i++) {
            float value = channels[i] > 0.0f ? fminf(channels[i], 1.0f) : 0.0f;
            if (i < 3 && self->format != GW_FORMAT_GLTF)
                value = gw_linear_from_srgb(value);
            out[(size_t)v * 4 + (size_t)i] = (uint8_t)lroundf(value * 255.0f);
        }
    }
}

static void put_mesh(converter *self, const struct aiMesh *mesh, const matrix *place) {
    gw_scene *scene = self->model->scene;
    const size_t first = self->vertices;
    const int mirrored = gw_matrix_determinant(place->m) < 0.0;
    double cofactors[3][3];
    gw_matrix_cofactors(place->m, cofactors);
    for (unsigned v = 0; v < mesh->mNumVertices; v++) {
        place_point(place, &mesh->mVertices[v], self->model->world + (first + v) * 3);
        if (scene->normals && mesh->mNormals)
            place_normal((const double(*)[3])cofactors, &mesh->mNormals[v], scene->normals + (first + v) * 3);
    }
    if (scene->tangents && has_tangents(self, mesh))
        put_tangents(self, mesh, place, scene->tangents + first);
    int32_t sets[2];
    texcoord_sets(self, mesh, sets);
    if (scene->texcoords)
        put_texcoords(mesh, sets[0], scene->texcoords + first * 2);
    if (scene->second_texcoords)
        put_texcoords(mesh, sets[1], scene->second_texcoords + first * 2);
    if (scene->colors)
        put_colors(self, mesh, scene->colors + first * 4);
    for (unsigned f = 0; f < mesh->mNumFaces; f++) {
        const struct aiFace *face = &mesh->mFaces[f];
        if (face->mNumIndices != 3)
            continue;
        uint32_t *triangle = scene->triangles[self->triangles];
        for (int k = 0; k < 3; k++) {
            const unsigned index = face->mIndices[mirrored ? 2 - k : k]; /* a mirror turns the winding */
            triangle[k] = index < mesh->mNumVertices ? (uint32_t)(first + index) : UINT32_MAX;
        }
        scene->material_of[self->triangles++] = mesh->mMaterialIndex;
    }
    self->vertices += mesh->mNumVertices;
}

/* "#7" or "#7-1": the place in the file's list, and of the primitive. 0 for other names. */
static int read_mark(const struct aiString *name, uint32_t *index, uint32_t *primitive) {
    unsigned long first, second = 0;
    char *end;
    if (name->data[0] != '#' || name->data[1] < '0' || name->data[1] > '9')
        return 0;
    first = strtoul(name->data + 1, &end, 10);
    if (*end == '-')
        second = strtoul(end + 1, &end, 10);
    *index = (uint32_t)first;
    *primitive = (uint32_t)second;
    return !*end && first < UINT32_MAX && second < UINT32_MAX;
}

/* Tells where the vertices that put_mesh is about to add come from, in files whose nodes and meshes are
 * marked (gw_gltf_mark). */
static gw_code put_span(converter *self, const struct aiNode *node, const struct aiMesh *mesh) {
    gw_source_model *model = self->model;
    uint32_t whole;
    gw_vertex_span span = {.first = (uint32_t)self->vertices, .count = mesh->mNumVertices};
    if (self->format != GW_FORMAT_GLTF || !read_mark(&node->mName, &span.node, &whole) ||
        !read_mark(&mesh->mName, &span.mesh, &span.primitive))
        return GW_OK;
    gw_code code = gw_grow((void **)&model->spans, &self->span_capacity, (size_t)model->span_count + 1,
                           sizeof span, "spans of vertices", self->error);
    if (code == GW_OK)
        model->spans[model->span_count++] = span;
    return code;
}

/* --- lights and cameras --- */

/* assimp keeps the range of KHR_lights_punctual with the node that carries the light. */
static float range_of(const struct aiNode *node) {
    const struct aiMetadata *data = node->mMetaData;
    for (unsigned i = 0; data && i < data->mNumProperties; i++)
        if (strcmp(data->mKeys[i].data, "PBR_LightRange") == 0 && data->mValues[i].mType == AI_FLOAT) {
            float range;
            memcpy(&range, data->mValues[i].mData, sizeof range);
            return range > 0.0f && range <= 1e30f ? range : 0.0f;
        }
    return 0.0f;
}

/* 0 where the node flattens the direction. Angles that the extension does not allow are brought in range. */
static int put_cone(const struct aiLight *light, const matrix *place, gw_light *to) {
    static const float most = 1.5707963f, least = 1e-4f;
    double axis[3];
    if (!place_direction(place, &light->mDirection, axis))
        return 0;
    const float outer = light->mAngleOuterCone, inner = light->mAngleInnerCone;
    to->kind = GW_LIGHT_SPOT;
    to->cone[1] = outer >= least ? fminf(outer, most) : outer < least ? least : most;
    to->cone[0] = inner >= 0.0f ? fminf(inner, to->cone[1] * 0.9999f) : 0.0f;
    for (int i = 0; i < 3; i++)
        to->axis[i] = (float)axis[i];
    return 1;
}

static void put_light(converter *self, const struct aiLight *light, const struct aiNode *node,
                      const matrix *place) {
    gw_scene *scene = self->model->scene;
    gw_light *to = &scene->lights[scene->light_count];
    *to = (gw_light){0};
    const float channels[3] = {(float)light->mColorDiffuse.r, (float)light->mColorDiffuse.g,
                               (float)light->mColorDiffuse.b};
    if (light->mType == aiLightSource_DIRECTIONAL) {
        to->kind = GW_LIGHT_DIRECTIONAL;
        if (!place_direction(place, &light->mDirection, to->vector))
            return;
    } else if (light->mType == aiLightSource_POINT || light->mType == aiLightSource_SPOT) {
        to->kind = GW_LIGHT_POINT;
        place_point(place, &light->mPosition, to->vector);
        to->range = range_of(node);
        if (light->mType == aiLightSource_SPOT && !put_cone(light, place, to))
            return;
    } else {
        return;
    }
    for (int i = 0; i < 3; i++)
        to->color[i] = channels[i] > 0.0f ? fminf(channels[i], 1e30f) : 0.0f;
    if (isfinite(to->vector[0]) && isfinite(to->vector[1]) && isfinite(to->vector[2]))
        scene->light_count++;
}

/* Only glTF brings cameras here. assimp 5.2.5 puts the node's shift into the camera as well (so it is left
 * out) and stores the vertical angle times the aspect ratio as the horizontal one. */
static void put_camera(converter *self, const struct aiCamera *camera, const matrix *place) {
    static const double degrees = 180.0 / 3.14159265358979323846;
    gw_scene *scene = self->model->scene;
    gw_viewpoint *view = &scene->viewpoints[scene->viewpoint_count];
    double forward[3];
    if (!place_direction(place, &camera->mLookAt, forward) || !place_direction(place, &camera->mUp, view->up))
        return;
    for (int i = 0; i < 3; i++) {
        view->eye[i] = place->m[i][3];
        view->look_at[i] = view->eye[i] + forward[i];
    }
    const double aspect = camera->mAspect > 0 ? (double)camera->mAspect : 1.0;
    const double fov = (double)camera->mHorizontalFOV / aspect * degrees;
    view->fov = fov >= 1.0 && fov <= 170.0 ? fov : 45.0;
    snprintf(view->name, sizeof view->name, "%.*s", (int)sizeof view->name - 1, camera->mName.data);
    if (isfinite(view->eye[0]) && isfinite(view->eye[1]) && isfinite(view->eye[2]))
        scene->viewpoint_count++;
}

/* assimp ties lights and cameras to nodes by name. */
static void put_node_lights(converter *self, const struct aiNode *node, const matrix *place) {
    for (unsigned i = 0; i < self->read->mNumLights && self->placed_lights < self->read->mNumLights; i++)
        if (strcmp(self->read->mLights[i]->mName.data, node->mName.data) == 0) {
            self->placed_lights++;
            put_light(self, self->read->mLights[i], node, place);
        }
    for (unsigned i = 0; i < self->read->mNumCameras && self->placed_cameras < self->read->mNumCameras; i++)
        if (strcmp(self->read->mCameras[i]->mName.data, node->mName.data) == 0) {
            self->placed_cameras++;
            put_camera(self, self->read->mCameras[i], place);
        }
}

/* --- the walk --- */

static gw_code walk(converter *self, const struct aiNode *node, const matrix *parent, int depth) {
    if (depth > MAXIMUM_NODE_DEPTH)
        return gw_fail(self->error, GW_BAD_INPUT, "its nodes are nested more than %d deep",
                       MAXIMUM_NODE_DEPTH);
    const matrix place = multiply(parent, &node->mTransformation);
    gw_code code = GW_OK;
    for (unsigned i = 0; code == GW_OK && i < node->mNumMeshes; i++) {
        if (node->mMeshes[i] >= self->read->mNumMeshes)
            return gw_fail(self->error, GW_BAD_INPUT, "a node names mesh %u of %u", node->mMeshes[i],
                           self->read->mNumMeshes);
        const struct aiMesh *mesh = self->read->mMeshes[node->mMeshes[i]];
        if (!self->counting)
            code = put_span(self, node, mesh);
        if (self->counting)
            count_mesh(self, mesh);
        else
            put_mesh(self, mesh, &place);
    }
    if (!self->counting)
        put_node_lights(self, node, &place);
    for (unsigned i = 0; code == GW_OK && i < node->mNumChildren; i++)
        code = walk(self, node->mChildren[i], &place, depth + 1);
    return code;
}

static gw_code allocate_scene(converter *self) {
    gw_scene *scene = self->model->scene;
    const struct {
        void *address;
        size_t count, row;
    } arrays[] = {
        {&self->model->world, self->vertices, 3 * sizeof(double)},
        {&scene->normals, self->normals ? self->vertices : 0, 3 * sizeof(float)},
        {&scene->tangents, self->tangents ? self->vertices : 0, sizeof *scene->tangents},
        {&scene->texcoords, self->texcoords ? self->vertices : 0, 2 * sizeof(float)},
        {&scene->second_texcoords, self->second_texcoords ? self->vertices : 0, 2 * sizeof(float)},
        {&scene->colors, self->colors ? self->vertices : 0, 4},
        {&scene->triangles, self->triangles, sizeof *scene->triangles},
        {&scene->material_of, self->triangles, sizeof *scene->material_of},
        {&scene->materials, self->read->mNumMaterials, sizeof *scene->materials},
        {&self->model->material_sources, self->read->mNumMaterials, sizeof *self->model->material_sources},
        {&scene->lights, self->read->mNumLights, sizeof *scene->lights},
        {&scene->viewpoints, self->read->mNumCameras, sizeof *scene->viewpoints},
    };
    gw_code code = GW_OK;
    for (size_t i = 0; code == GW_OK && i < sizeof arrays / sizeof *arrays; i++)
        code = gw_allocate(arrays[i].address, arrays[i].count, arrays[i].row, "imported model", self->error);
    return code;
}

static gw_code convert_materials(converter *self) {
    gw_scene *scene = self->model->scene;
    const gw_material_extension none = gw_material_extension_none();
    int extended = 0;
    scene->material_count = self->read->mNumMaterials;
    if (self->format == GW_FORMAT_OBJ && gw_scene_extend_materials(scene, self->error) != GW_OK)
        return GW_MACHINE;
    for (uint32_t i = 0; i < scene->material_count; i++) {
        gw_code code = gw_import_material(self->read, self->read->mMaterials[i], self->format, self->files,
                                          self->model, i, self->error);
        if (code != GW_OK)
            return code;
        extended |= scene->extensions && memcmp(&none, &scene->extensions[i], sizeof none) != 0;
        if (self->format != GW_FORMAT_GLTF && self->format != GW_FORMAT_OBJ && self->colors)
            for (int k = 0; k < 3; k++) /* the vertices bring the colour */
                scene->materials[i].base_color[k] = 1.0f;
    }
    if (!extended) {
        free(scene->extensions);
        scene->extensions = NULL;
    }
    return GW_OK;
}

static gw_code note_choices(const converter *self) {
    gw_scene *scene = self->model->scene;
    gw_code code = GW_OK;
    if (self->format != GW_FORMAT_GLTF && self->format != GW_FORMAT_OBJ)
        code = gw_scene_note(scene, self->error, "%s files name no material: a rough %s is used",
                             gw_model_format_name(self->format),
                             self->colors ? "one with the vertices' colours" : "light grey one");
    if (code == GW_OK && self->bad_tangents)
        code =
            gw_scene_note(scene, self->error,
                          "glTF: %llu tangents were zero-length, not finite, along their normal or without "
                          "a side: those of texture coordinates are used there",
                          (unsigned long long)self->bad_tangents);
    if (code == GW_OK && self->format == GW_FORMAT_OBJ)
        code = gw_import_mtl_notes(self->read, self->files, self->model, self->error);
    return code;
}

gw_code gw_import_convert(const struct aiScene *read, gw_model_format format, const gw_import_files *files,
                          gw_source_model *model, gw_error *error) {
    const matrix identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    converter self = {
        .read = read, .format = format, .files = files, .model = model, .counting = 1, .error = error};
    gw_code code = walk(&self, read->mRootNode, &identity, 0);
    if (code != GW_OK)
        return code;
    if (self.vertices >= UINT32_MAX || self.triangles >= UINT32_MAX)
        return gw_fail(error, GW_BAD_INPUT,
                       "it has %llu vertices and %llu triangles, more than a scene can hold",
                       (unsigned long long)self.vertices, (unsigned long long)self.triangles);
    code = allocate_scene(&self);
    if (code != GW_OK)
        return code;
    model->scene->dropped.not_triangle = self.other_primitives;
    model->wants_normals = !self.normals && format != GW_FORMAT_GLTF;
    self.counting = 0;
    self.vertices = self.triangles = 0;
    code = walk(&self, read->mRootNode, &identity, 0);
    model->scene->vertex_count = (uint32_t)self.vertices;
    model->scene->triangle_count = (uint32_t)self.triangles;
    if (code == GW_OK)
        code = convert_materials(&self);
    if (code == GW_OK)
        code = note_choices(&self);
    return code;
}

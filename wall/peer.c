#include "wall/peer.h"

#if defined(__has_include)
#if __has_include(<embree3/rtcore.h>)
#define GW_HAS_EMBREE 1
#endif
#endif

#ifdef GW_HAS_EMBREE

#include "base/memory.h"

#include <dlfcn.h>
#include <embree3/rtcore.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LIBRARY "libembree3.so.3"

/* What is used of Embree, by the names of its own header. */
#define FUNCTIONS(X)                                                                                         \
    X(rtcNewDevice)                                                                                          \
    X(rtcReleaseDevice)                                                                                      \
    X(rtcGetDeviceError)                                                                                     \
    X(rtcGetDeviceProperty)                                                                                  \
    X(rtcNewScene)                                                                                           \
    X(rtcReleaseScene)                                                                                       \
    X(rtcSetSceneFlags)                                                                                      \
    X(rtcSetSceneBuildQuality)                                                                               \
    X(rtcCommitScene)                                                                                        \
    X(rtcNewGeometry)                                                                                        \
    X(rtcReleaseGeometry)                                                                                    \
    X(rtcSetNewGeometryBuffer)                                                                               \
    X(rtcCommitGeometry)                                                                                     \
    X(rtcAttachGeometry)                                                                                     \
    X(rtcIntersect1)                                                                                         \
    X(rtcIntersect1M)

struct gw_peer {
    void *library;
#define MEMBER(name) __typeof__(name) *name;
    FUNCTIONS(MEMBER)
#undef MEMBER
    RTCDevice device;
    RTCScene scene;
    char name[32];
};

static gw_code load(gw_peer *peer, gw_error *error) {
    peer->library = dlopen(LIBRARY, RTLD_NOW | RTLD_LOCAL);
    if (!peer->library)
        return gw_fail(error, GW_MACHINE,
                       "Embree is not installed (%s); install libembree3-3 to compare with it", dlerror());
#define FIND(name)                                                                                           \
    {                                                                                                        \
        void *address = dlsym(peer->library, #name);                                                         \
        if (!address)                                                                                        \
            return gw_fail(error, GW_MACHINE, "%s has no function %s", LIBRARY, #name);                      \
        memcpy(&peer->name, &address, sizeof address);                                                       \
    }
    FUNCTIONS(FIND)
#undef FIND
    return GW_OK;
}

static gw_code fill_scene(gw_peer *peer, const gw_scene *scene, int robust, gw_error *error) {
    RTCGeometry geometry = peer->rtcNewGeometry(peer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vertices = peer->rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                    3 * sizeof(float), scene->vertex_count);
    uint32_t *triangles = peer->rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                        3 * sizeof(uint32_t), scene->triangle_count);
    if (vertices && triangles) {
        memcpy(vertices, scene->positions, (size_t)scene->vertex_count * 3 * sizeof(float));
        memcpy(triangles, scene->triangles, (size_t)scene->triangle_count * 3 * sizeof(uint32_t));
        peer->rtcCommitGeometry(geometry);
        peer->scene = peer->rtcNewScene(peer->device);
        peer->rtcSetSceneFlags(peer->scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
        peer->rtcSetSceneBuildQuality(peer->scene, RTC_BUILD_QUALITY_HIGH);
        peer->rtcAttachGeometry(peer->scene, geometry);
        peer->rtcCommitScene(peer->scene);
    }
    peer->rtcReleaseGeometry(geometry);
    enum RTCError failed = peer->rtcGetDeviceError(peer->device);
    return failed ? gw_fail(error, GW_MACHINE, "Embree could not build its structure (error %d)", (int)failed)
                  : GW_OK;
}

gw_code gw_peer_create(const gw_scene *scene, int robust, gw_peer **out, gw_error *error) {
    gw_peer *peer = NULL;
    gw_code code = gw_allocate((void **)&peer, 1, sizeof *peer, "Embree's state", error);
    if (code)
        return code;
    code = load(peer, error);
    if (!code) {
        peer->device = peer->rtcNewDevice(NULL);
        if (!peer->device)
            code = gw_fail(error, GW_MACHINE, "Embree could not open its device");
    }
    if (!code) {
        snprintf(peer->name, sizeof peer->name, "Embree %ld.%ld.%ld",
                 (long)peer->rtcGetDeviceProperty(peer->device, RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                 (long)peer->rtcGetDeviceProperty(peer->device, RTC_DEVICE_PROPERTY_VERSION_MINOR),
                 (long)peer->rtcGetDeviceProperty(peer->device, RTC_DEVICE_PROPERTY_VERSION_PATCH));
        code = fill_scene(peer, scene, robust, error);
    }
    if (code)
        gw_peer_destroy(&peer);
    *out = peer;
    return code;
}

void gw_peer_destroy(gw_peer **peer) {
    gw_peer *p = *peer;
    if (!p)
        return;
    if (p->scene)
        p->rtcReleaseScene(p->scene);
    if (p->device)
        p->rtcReleaseDevice(p->device);
    /* The library stays loaded: its threads may still be on their way out. */
    free(p);
    *peer = NULL;
}

const char *gw_peer_name(const gw_peer *peer) {
    return peer->name;
}

/* A thread's part of the rays. */
typedef struct part {
    gw_peer *peer;
    gw_peer_way way;
    const gw_ray *rays;
    gw_hit *hits;
    size_t begin, end;
} part;

enum { BATCH = 256 };

static struct RTCRayHit query_of(const gw_ray *ray) {
    struct RTCRayHit query = {0};
    query.ray.org_x = ray->origin[0];
    query.ray.org_y = ray->origin[1];
    query.ray.org_z = ray->origin[2];
    query.ray.dir_x = ray->direction[0];
    query.ray.dir_y = ray->direction[1];
    query.ray.dir_z = ray->direction[2];
    query.ray.tnear = ray->minimum;
    query.ray.tfar = ray->maximum;
    query.ray.mask = UINT32_MAX;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
}

static gw_hit hit_of(const struct RTCRayHit *answer, const gw_ray *ray) {
    int met = answer->hit.geomID != RTC_INVALID_GEOMETRY_ID;
    return (gw_hit){.t = met ? answer->ray.tfar : ray->maximum,
                    .triangle = met ? answer->hit.primID : GW_NO_TRIANGLE};
}

static void trace_singly(const part *p, size_t begin, size_t count) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (size_t i = begin; i < begin + count; i++) {
        struct RTCRayHit query = query_of(&p->rays[i]);
        p->peer->rtcIntersect1(p->peer->scene, &context, &query);
        p->hits[i] = hit_of(&query, &p->rays[i]);
    }
}

static void trace_stream(const part *p, size_t begin, size_t count) {
    struct RTCRayHit batch[BATCH];
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (size_t i = 0; i < count; i++)
        batch[i] = query_of(&p->rays[begin + i]);
    p->peer->rtcIntersect1M(p->peer->scene, &context, batch, (unsigned)count, sizeof batch[0]);
    for (size_t i = 0; i < count; i++)
        p->hits[begin + i] = hit_of(&batch[i], &p->rays[begin + i]);
}

static void *trace_part(void *argument) {
    const part *p = argument;
    for (size_t begin = p->begin; begin < p->end; begin += BATCH) {
        size_t count = p->end - begin < BATCH ? p->end - begin : BATCH;
        if (p->way == GW_PEER_SINGLE)
            trace_singly(p, begin, count);
        else
            trace_stream(p, begin, count);
    }
    return NULL;
}

gw_code gw_peer_trace(gw_peer *peer, gw_peer_way way, const gw_ray *rays, size_t count, gw_hit *hits,
                      gw_error *error) {
    enum { MOST_THREADS = 64 };
    part parts[MOST_THREADS];
    pthread_t threads[MOST_THREADS];
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    size_t thread_count = processors < 1 ? 1 : processors > MOST_THREADS ? MOST_THREADS : (size_t)processors;
    size_t started = 0;
    for (size_t i = 0; i < thread_count; i++) {
        parts[i] = (part){peer, way, rays, hits, count * i / thread_count, count * (i + 1) / thread_count};
        if (pthread_create(&threads[i], NULL, trace_part, &parts[i]))
            break;
        started++;
    }
    for (size_t i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    return started == thread_count ? GW_OK
                                   : gw_fail(error, GW_MACHINE, "a thread for Embree could not be started");
}

#else

struct gw_peer {
    int none;
};

gw_code gw_peer_create(const gw_scene *scene, int robust, gw_peer **out, gw_error *error) {
    (void)scene, (void)robust;
    *out = NULL;
    return gw_fail(error, GW_MACHINE,
                   "this program was built without Embree's header; install libembree-dev and build again");
}

void gw_peer_destroy(gw_peer **peer) {
    *peer = NULL;
}

const char *gw_peer_name(const gw_peer *peer) {
    (void)peer;
    return "none";
}

gw_code gw_peer_trace(gw_peer *peer, gw_peer_way way, const gw_ray *rays, size_t count, gw_hit *hits,
                      gw_error *error) {
    (void)peer, (void)way, (void)rays, (void)count, (void)hits;
    return gw_fail(error, GW_MACHINE, "there is no Embree in this program");
}

#endif

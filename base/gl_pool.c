/* Storage of buffers that are made anew again and again. */
#include "base/gl_private.h"

#include "base/memory.h"

#include <stdlib.h>

/* Sizes come in classes, four to a power of two, and storage is used again within its class only: then work
 * that is repeated needs nothing new, in whatever order it asks. */
static size_t capacity_for(const gw_gl_pool *pool, size_t size) {
    size_t step = 16;
    if (!pool->on)
        return size;
    while (step * 8 <= size)
        step *= 2;
    return (size + step - 1) / step * step;
}

void gw_gl_pool_take(gw_gl *device, size_t size, GLuint *id, size_t *capacity) {
    gw_gl_pool *pool = &device->pool;
    *capacity = capacity_for(pool, size);
    for (size_t i = 0; i < pool->idle_count; i++)
        if (pool->idle[i].capacity == *capacity) {
            *id = pool->idle[i].id;
            pool->idle[i] = pool->idle[--pool->idle_count];
            pool->reused++;
            glMemoryBarrier(GL_ALL_BARRIER_BITS); /* shaders may have written the buffer that it was */
            return;
        }
    glCreateBuffers(1, id);
    glNamedBufferStorage(*id, (GLsizeiptr)*capacity, NULL, GL_DYNAMIC_STORAGE_BIT);
    pool->made++;
    if (glGetError() != GL_NO_ERROR) {
        glDeleteBuffers(1, id);
        *id = 0;
    }
}

void gw_gl_pool_give(gw_gl *device, GLuint id, size_t capacity) {
    gw_gl_pool *pool = device ? &device->pool : NULL;
    if (pool && pool->on &&
        gw_grow((void **)&pool->idle, &pool->idle_capacity, pool->idle_count + 1, sizeof *pool->idle,
                "idle buffers", NULL) == GW_OK)
        pool->idle[pool->idle_count++] = (gw_gl_idle){id, capacity};
    else
        glDeleteBuffers(1, &id);
}

void gw_gl_pool_start(gw_gl *device) {
    device->pool.on = 1;
}

void gw_gl_pool_stop(gw_gl *device) {
    gw_gl_pool *pool = &device->pool;
    for (size_t i = 0; i < pool->idle_count; i++)
        glDeleteBuffers(1, &pool->idle[i].id);
    free(pool->idle);
    pool->idle = NULL;
    pool->idle_count = pool->idle_capacity = 0;
    pool->on = 0;
}

gw_gl_pool_counts gw_gl_pool_counts_of(const gw_gl *device) {
    const gw_gl_pool *pool = &device->pool;
    gw_gl_pool_counts counts = {.made = pool->made, .reused = pool->reused};
    for (size_t i = 0; i < pool->idle_count; i++)
        counts.idle_bytes += pool->idle[i].capacity;
    return counts;
}

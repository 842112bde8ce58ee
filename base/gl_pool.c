/* Storage of buffers that are made anew again and again. */
#include "base/gl_private.h"

#include "base/memory.h"

#include <stdlib.h>

/* New storage of a pool is larger than asked for by up to an eighth, so that a buffer which grows a little
 * finds its old storage again. */
static size_t capacity_for(const gw_gl *device, size_t size) {
    size_t step = 16;
    if (!device->pool.on)
        return size;
    while (step * 16 <= size)
        step *= 2;
    return (size + step - 1) / step * step;
}

/* The least idle storage that fits, unless most of it would be wasted; idle_count when there is none. */
static size_t find_idle(const gw_gl_pool *pool, size_t size) {
    enum { WASTE_THAT_IS_FINE = 1 << 16 };
    size_t best = pool->idle_count;
    for (size_t i = 0; i < pool->idle_count; i++) {
        const size_t capacity = pool->idle[i].capacity;
        if (capacity >= size && capacity / 2 <= size + WASTE_THAT_IS_FINE &&
            (best == pool->idle_count || capacity < pool->idle[best].capacity))
            best = i;
    }
    return best;
}

void gw_gl_pool_take(gw_gl *device, size_t size, GLuint *id, size_t *capacity) {
    gw_gl_pool *pool = &device->pool;
    const size_t found = pool->on ? find_idle(pool, size) : pool->idle_count;
    if (found < pool->idle_count) {
        *id = pool->idle[found].id;
        *capacity = pool->idle[found].capacity;
        pool->idle[found] = pool->idle[--pool->idle_count];
        pool->reused++;
        glMemoryBarrier(GL_ALL_BARRIER_BITS); /* shaders may have written the buffer that it was */
        return;
    }
    *capacity = capacity_for(device, size);
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

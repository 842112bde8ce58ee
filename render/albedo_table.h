/* How much light a rough surface reflects in all directions together, by roughness and angle of view: tables
 * that shading reads (shaders/shade/brdf.glsl). The same bits on every machine. Filling: any thread. */
#ifndef GW_RENDER_ALBEDO_TABLE_H
#define GW_RENDER_ALBEDO_TABLE_H

#include <epoxy/gl.h>

enum { GW_ALBEDO_SIDE = 32 };

/* GGX with height-correlated Smith masking, in [roughness][cosine]: roughness 0..1 is perceptual, the square
 * root of the cosine to the view 0..1. [0]: albedo where Fresnel's term is 1; [1]: the part of it that is
 * weighted by Schlick's (1 - v.h)^5, so that reflectances f0 at 0 and f90 at 90 degrees have the albedo
 * f0 [0] + (f90 - f0) [1] (Karis, Real Shading in Unreal Engine 4, 2013). Error below 0.002, 0.02 below 1
 * degree of grazing and roughness 0.1. */
void gw_albedo_table_fill(float table[GW_ALBEDO_SIDE][GW_ALBEDO_SIDE][2]);

/* The same for sheen: Charlie's distribution (Estevez and Kulla, Production Friendly Microfacet Sheen BRDF,
 * 2017) with the visibility of Neubelt and Pettineo (2013), as KHR_materials_sheen has them. */
void gw_sheen_table_fill(float table[GW_ALBEDO_SIDE][GW_ALBEDO_SIDE]);

/* A filled table (GL_RG32F and GL_RG, or GL_R32F and GL_RED for sheen) as shading reads it. Belongs to the
 * thread of the current GL context; the caller deletes it. */
GLuint gw_albedo_table_texture(GLenum format, GLenum layout, const void *texels);

#endif

/* The tangent of a vertex as a file gives it, in one word: an octahedral direction of 15 bits a coordinate
 * (off by at most 0.008 degrees) and which way the other axis of the map goes. The same bits on every
 * machine. Any thread. */
#ifndef GW_BUILD_TANGENT_H
#define GW_BUILD_TANGENT_H

#include <stdint.h>

/* direction: along the map's u, of any length. side: 1 or -1, the map's upward axis is side * cross(normal,
 * direction). 0, which is no tangent, for what has no direction or side. */
uint32_t gw_tangent_pack(const double direction[3], double side);
/* Returns the side and fills the unit direction; 0: there is none, and direction stays. */
int gw_tangent_unpack(uint32_t word, double direction[3]);
/* Through a transform of points. One that mirrors turns the side over: the surface's upward axis is mirrored,
 * the cross product is not. */
uint32_t gw_tangent_transform(const double m[3][4], uint32_t word);

#endif

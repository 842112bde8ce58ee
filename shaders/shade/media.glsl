// The media that a ray is in, as a stack of four numbers of 16 bits, 0 for none, the innermost in the lowest bits. The one that
// was entered last counts (a ball of glass in water, a bubble in glass, and after Schmidt and Budge, Simple Nested Dielectrics in
// Ray Traced Images, 2002, water that reaches into the wall of its glass): the surface of any other is passed as if it were not
// there. A set, not a count: what is entered twice is left once, so rounding at the edge between two triangles does no harm.

uint innermost_medium(uvec2 media) {
    return media.x & 0xffffu;
}

bool in_medium(uvec2 media, uint medium) {
    return any(equal(uvec4(media & 0xffffu, media >> 16), uvec4(medium)));
}

// A fifth medium displaces the outermost.
uvec2 with_medium(uvec2 media, uint medium) {
    return uvec2((media.x << 16) | medium, (media.y << 16) | (media.x >> 16));
}

uvec2 without_medium(uvec2 media, uint medium) {
    uint words[4] = uint[](media.x & 0xffffu, media.x >> 16, media.y & 0xffffu, media.y >> 16);
    uint kept[4] = uint[](0u, 0u, 0u, 0u);
    int count = 0;
    for (int i = 0; i < 4; ++i)
        if (words[i] != medium)
            kept[count++] = words[i];
    return uvec2(kept[0] | (kept[1] << 16), kept[2] | (kept[3] << 16));
}

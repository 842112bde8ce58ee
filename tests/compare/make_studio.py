"""Writes the environment that scenes are compared under, as a Radiance picture: a grey room with a pale ceiling, three
softboxes of different colour and size, and a floor.   python3 tests/compare/make_studio.py FILE.hdr"""
import math
import struct
import sys

WIDTH, HEIGHT = 512, 256
# Middle (degrees to the right of -z, degrees up), half width, half height, radiance.
BOXES = [
    ((-55, 50), (20, 12), (14.0, 13.0, 11.5)),
    ((70, 30), (9, 22), (5.0, 6.0, 8.0)),
    ((165, 35), (25, 8), (6.0, 5.5, 5.0)),
]


def radiance(turn, up):
    for (middle, height), (half_width, half_height), color in BOXES:
        across = (turn - middle + 180) % 360 - 180
        if abs(across) <= half_width and abs(up - height) <= half_height:
            return color
    if up < 0:
        shade = 0.10 + 0.06 * math.exp(up / 15)
        return (shade * 1.05, shade, shade * 0.92)
    shade = 0.22 + 0.35 * math.sin(math.radians(up))
    return (shade * 0.95, shade, shade * 1.08)


def rgbe(color):
    mantissa, exponent = math.frexp(max(color))
    scale = mantissa * 256 / max(color)
    return struct.pack("4B", *(int(channel * scale) for channel in color), exponent + 128)


def main():
    rows = []
    for y in range(HEIGHT):
        up = 90 - (y + 0.5) * 180 / HEIGHT
        rows += [rgbe(radiance((x + 0.5) * 360 / WIDTH - 180, up)) for x in range(WIDTH)]
    with open(sys.argv[1], "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (HEIGHT, WIDTH))
        file.write(b"".join(rows))


main()

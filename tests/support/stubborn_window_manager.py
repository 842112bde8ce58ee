# A window manager of the stubborn kind, on the X display of $DISPLAY (":N", no password): whatever size and place a window asks
# for, it gets 300x200 px at 20,20. Speaks the X11 protocol itself: http://www.x.org/releases/X11R7.7/doc/xproto/x11protocol.html
import os
import socket
import struct

SUBSTRUCTURE_REDIRECT = 0x100000
CHANGE_ATTRIBUTES, MAP_WINDOW, CONFIGURE_WINDOW = 2, 8, 12
MAP_REQUEST, CONFIGURE_REQUEST = 20, 23
PLACE = (20, 20, 300, 200)

line = socket.socket(socket.AF_UNIX)
line.connect("/tmp/.X11-unix/X" + os.environ["DISPLAY"].split(":")[1].split(".")[0])


def receive(size):
    data = b""
    while len(data) < size:
        part = line.recv(size - len(data))
        if not part:
            raise SystemExit(0)
        data += part
    return data


def configure(window):
    line.sendall(struct.pack("<BBHIHHIIII", CONFIGURE_WINDOW, 0, 7, window, 15, 0, *PLACE))


line.sendall(struct.pack("<BBHHHHH", ord("l"), 0, 11, 0, 0, 0, 0))
head = receive(8)
assert head[0] == 1, "the X server does not let its window manager in"
setup = receive(struct.unpack("<H", head[6:8])[0] * 4)
vendor, formats = struct.unpack("<H", setup[16:18])[0], setup[21]
root = struct.unpack("<I", setup[32 + (vendor + 3) // 4 * 4 + 8 * formats:][:4])[0]
line.sendall(struct.pack("<BBHIII", CHANGE_ATTRIBUTES, 0, 4, root, 1 << 11, SUBSTRUCTURE_REDIRECT))
print("here", flush=True)
while True:
    event = receive(32)
    assert event[0] != 0, "error %d of the X server" % event[1]
    window = struct.unpack("<I", event[8:12])[0]
    if event[0] & 127 == CONFIGURE_REQUEST:
        configure(window)
    elif event[0] & 127 == MAP_REQUEST:
        configure(window)
        line.sendall(struct.pack("<BBHI", MAP_WINDOW, 0, 2, window))

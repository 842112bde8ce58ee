#!/usr/bin/env python3
"""A person and a DTrack controller, for the tests of `gazewall calibrate`.

hold_sensor.py POSES PROGRAM ARGUMENT...

POSES is a file: line N is for mark or target N, "x y z" mm and nine numbers of a matrix, column by column, or "-" for
a body that is not seen. Body 0 is reported there by UDP, some 200 times a second, from the moment it is asked for; then
Enter is pressed. @PORT@ in arguments, and in files that end in .yaml, becomes the port. What the program prints goes on
to this one's streams; its exit code is this one's."""
import re, select, socket, subprocess, sys, time

link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
free = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
free.bind(("127.0.0.1", 0))
port = free.getsockname()[1]
free.close()
poses = [line.split() for line in open(sys.argv[1]) if line.strip()]
frame = 0


def send(pose):
    global frame
    frame += 1
    if pose[0] != "-":
        line = "fr %d\r\n6d 1 [0 1.000][%s 0 0 0][%s]\r\n" % (frame, " ".join(pose[:3]), " ".join(pose[3:]))
        link.sendto(line.encode(), ("127.0.0.1", port))
    time.sleep(0.005)


arguments = [argument.replace("@PORT@", str(port)) for argument in sys.argv[2:]]
for name in arguments:
    if name.endswith(".yaml"):
        text = open(name).read()
        open(name, "w").write(text.replace("@PORT@", str(port)))
program = subprocess.Popen(arguments, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
text, asked, at = b"", 0, 0
while True:
    while select.select([program.stderr], [], [], 0)[0]:
        more = program.stderr.read1(65536)
        if not more:
            sys.exit(program.wait())
        sys.stderr.buffer.write(more)
        text += more
    prompts = re.findall(rb"(?:mark|target) (\d+) of .*press Enter\n", text)
    if len(prompts) > asked:
        asked, at = len(prompts), int(prompts[-1]) - 1
        for _ in range(10):  # what was on its way from the mark before is gone
            send(poses[at])
        program.stdin.write(b"\n")
        program.stdin.flush()
    send(poses[at])

#include "wall/video.h"

#include "base/file.h"
#include "base/memory.h"
#include "wall/spawn.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { WORDS_BYTES = 1024, CHILD_FILE = 3 };

struct gw_video {
    char *path, *temporary; /* temporary: "" while the file has no name */
    uint32_t width, height;
    pid_t ffmpeg;
    int frames, file, words; /* descriptors: a socket to ffmpeg, the video, ffmpeg's standard error */
    char said[WORDS_BYTES];  /* the last of ffmpeg's words */
    size_t said_size;
};

/* ffmpeg's name of the container for an ending, or NULL. */
static const char *container_of(const char *path) {
    static const char *const endings[][2] = {
        {".mp4", "mp4"}, {".m4v", "mp4"}, {".mov", "mov"}, {".mkv", "matroska"}};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        if (gw_path_has_extension(path, endings[i][0]))
            return endings[i][1];
    return NULL;
}

static int is_installed(const char *program) {
    const char *list = getenv("PATH");
    char path[4096];
    for (const char *at = list ? list : "/usr/bin:/bin"; at; at = strchr(at, ':'), at += at != NULL) {
        snprintf(path, sizeof path, "%.*s/%s", (int)strcspn(at, ":"), at, program);
        if (access(path, X_OK) == 0)
            return 1;
    }
    return 0;
}

gw_code gw_video_check(const char *path, gw_error *error) {
    if (!path)
        return GW_OK;
    if (!container_of(path))
        return gw_fail(error, GW_BAD_INPUT, "%s: a video ends in .mp4, .m4v, .mov or .mkv", path);
    if (!is_installed("ffmpeg"))
        return gw_fail(
            error, GW_MACHINE,
            "--video needs ffmpeg, which is not installed: apt-get install ffmpeg; or leave out --video "
            "and take the pictures of --out");
    return gw_file_writable(path, error);
}

/* A file that nobody sees yet, in the folder of the video. */
static gw_code open_file(gw_video *video, gw_error *error) {
    char *folder = gw_path_folder(video->path);
    video->file = folder ? open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0644) : -1;
    video->temporary[0] = '\0';
    if (video->file < 0 && folder) {
        sprintf(video->temporary, "%s/.%s.%ld.part", folder, gw_path_name(video->path), (long)getpid());
        video->file = open(video->temporary, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0644);
    }
    free(folder);
    if (video->file < 0) {
        video->temporary[0] = '\0';
        return gw_fail(error, GW_NO_OUTPUT, "%s cannot be written: %s", video->path, strerror(errno));
    }
    return GW_OK;
}

/* `gazewall launch PID` ties ffmpeg's life to ours. */
static gw_code spawn(gw_video *video, double rate, int input, int output, gw_error *error) {
    char size[32], pid[24], rate_text[40], file[40];
    snprintf(size, sizeof size, "%" PRIu32 "x%" PRIu32, video->width, video->height);
    snprintf(pid, sizeof pid, "%ld", (long)getpid());
    snprintf(rate_text, sizeof rate_text, "%.9g", rate);
    snprintf(file, sizeof file, "/proc/self/fd/%d", CHILD_FILE);
    const char *const words[] = {
        "/proc/self/exe", "launch", pid, "ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin",
        /* Without it a full disk at the end, where the index is written, is exit code 0. */
        "-xerror", "-f", "rawvideo", "-pixel_format", "rgba", "-video_size", size, "-framerate", rate_text,
        "-i", "pipe:0", "-an",
        /* H.264 in 4:2:0 wants even sides. */
        "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
        "-c:v", "libx264", "-crf", "16", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc",
        "iec61966-2-1", "-f", container_of(video->path), "-y", file, NULL};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
    posix_spawn_file_actions_adddup2(&actions, video->file, CHILD_FILE);
    int failed = gw_spawn(&video->ffmpeg, words, &actions, GW_SPAWN_SAME_GROUP);
    if (failed) {
        video->ffmpeg = 0;
        return gw_fail(error, GW_MACHINE, "ffmpeg cannot be started: %s", strerror(failed));
    }
    return GW_OK;
}

static gw_code start(gw_video *video, double rate, gw_error *error) {
    int frames[2], words[2];
    /* A socket, because writing to one whose reader is gone is an error and no signal. */
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, frames))
        return gw_fail(error, GW_MACHINE, "no line to ffmpeg: %s", strerror(errno));
    video->frames = frames[0];
    if (pipe2(words, O_CLOEXEC | O_NONBLOCK)) {
        close(frames[1]);
        return gw_fail(error, GW_MACHINE, "no line from ffmpeg: %s", strerror(errno));
    }
    video->words = words[0];
    gw_code code = spawn(video, rate, frames[1], words[1], error);
    close(frames[1]);
    close(words[1]);
    return code;
}

gw_code gw_video_open(const char *path, uint32_t width, uint32_t height, double rate, gw_video **out,
                      gw_error *error) {
    gw_video *video = NULL;
    gw_code code = gw_video_check(path, error);
    if (!code)
        code = gw_allocate((void **)&video, 1, sizeof *video, "video", error);
    if (code)
        return code;
    video->file = video->frames = video->words = -1;
    video->width = width;
    video->height = height;
    video->path = strdup(path);
    code = gw_allocate((void **)&video->temporary, strlen(path) + 64, 1, "video", error);
    if (!code && !video->path)
        code = gw_fail(error, GW_MACHINE, "memory is out while opening %s", path);
    if (!code)
        code = open_file(video, error);
    if (!code)
        code = start(video, rate, error);
    if (code)
        gw_video_abandon(&video);
    *out = video;
    return code;
}

/* What ffmpeg has said so far; the last of it is kept. */
static void hear(gw_video *video) {
    char heard[WORDS_BYTES / 2];
    ssize_t size;
    while ((size = read(video->words, heard, sizeof heard)) > 0) {
        const size_t new = (size_t)size;
        if (video->said_size + new > sizeof video->said - 1) {
            const size_t gone = video->said_size + new - (sizeof video->said - 1);
            memmove(video->said, video->said + gone, video->said_size - gone);
            video->said_size -= gone;
        }
        memcpy(video->said + video->said_size, heard, new);
        video->said_size += new;
    }
    while (video->said_size > 0 && strchr("\r\n ", video->said[video->said_size - 1]))
        video->said_size--;
    video->said[video->said_size] = '\0';
}

static gw_code fail(gw_video *video, gw_error *error) {
    int status = 0;
    close(video->frames);
    video->frames = -1;
    if (video->ffmpeg > 0 && waitpid(video->ffmpeg, &status, 0) == video->ffmpeg)
        video->ffmpeg = 0;
    hear(video);
    return gw_fail(error, GW_NO_OUTPUT, "%s: ffmpeg gave up%s%s; nothing was written", video->path,
                   video->said_size ? ": " : " and did not say why", video->said);
}

gw_code gw_video_frame(gw_video *video, const gw_image *image, gw_error *error) {
    const uint8_t *at = image->rgba;
    size_t left = (size_t)image->width * image->height * 4;
    if (image->width != video->width || image->height != video->height)
        return gw_fail(error, GW_BAD_INPUT,
                       "%s: a frame of %ux%u px does not fit a video of %" PRIu32 "x%" PRIu32, video->path,
                       image->width, image->height, video->width, video->height);
    while (left > 0) {
        ssize_t sent = send(video->frames, at, left, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent < 0)
            return fail(video, error);
        at += sent;
        left -= (size_t)sent;
        hear(video);
    }
    return GW_OK;
}

/* The finished file under its own name, in one step. */
static gw_code name_file(gw_video *video, gw_error *error) {
    if (!video->temporary[0]) {
        char *folder = gw_path_folder(video->path), from[40];
        snprintf(from, sizeof from, "/proc/self/fd/%d", video->file);
        sprintf(video->temporary, "%s/.%s.%ld.part", folder ? folder : ".", gw_path_name(video->path),
                (long)getpid());
        free(folder);
        if (linkat(AT_FDCWD, from, AT_FDCWD, video->temporary, AT_SYMLINK_FOLLOW)) {
            video->temporary[0] = '\0';
            return gw_fail(error, GW_NO_OUTPUT, "%s cannot be named: %s", video->path, strerror(errno));
        }
    }
    if (rename(video->temporary, video->path))
        return gw_fail(error, GW_NO_OUTPUT, "%s cannot be named: %s", video->path, strerror(errno));
    video->temporary[0] = '\0';
    return GW_OK;
}

gw_code gw_video_close(gw_video **video, gw_error *error) {
    gw_video *v = *video;
    if (!v)
        return GW_OK;
    int status = 0;
    close(v->frames);
    v->frames = -1;
    while (waitpid(v->ffmpeg, &status, 0) < 0 && errno == EINTR)
        ;
    v->ffmpeg = 0;
    hear(v);
    gw_code code = GW_OK;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        code = gw_fail(error, GW_NO_OUTPUT, "%s: ffmpeg failed%s%s; nothing was written", v->path,
                       v->said_size ? ": " : " and did not say why", v->said);
    else
        code = name_file(v, error);
    gw_video_abandon(video);
    return code;
}

void gw_video_abandon(gw_video **video) {
    gw_video *v = *video;
    if (!v)
        return;
    if (v->ffmpeg > 0) {
        kill(v->ffmpeg, SIGKILL);
        waitpid(v->ffmpeg, NULL, 0);
    }
    const int descriptors[] = {v->frames, v->words, v->file};
    for (size_t i = 0; i < 3; i++)
        if (descriptors[i] >= 0)
            close(descriptors[i]);
    if (v->temporary && v->temporary[0])
        unlink(v->temporary);
    free(v->temporary);
    free(v->path);
    free(v);
    *video = NULL;
}

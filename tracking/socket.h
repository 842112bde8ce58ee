/* What the tracking protocols need of sockets: IPv4, never waiting, closed in child processes. Functions that
 * make one return a descriptor, or -1 with errno set. Any thread. */
#ifndef GW_TRACKING_SOCKET_H
#define GW_TRACKING_SOCKET_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct gw_endpoint {
    char address[16]; /* dotted; "": any */
    uint16_t port;    /* 0: any */
} gw_endpoint;

/* "[ADDRESS:]PORT". An empty text leaves *out, the default, as it is; a missing address leaves that. what
 * names the text in the error. */
gw_code gw_endpoint_parse(const char *text, const char *what, gw_endpoint *out, gw_error *error);
int gw_endpoint_equal(const gw_endpoint *a, const gw_endpoint *b);
int gw_address_is_numeric(const char *address);
int gw_address_is_multicast(const char *address);

/* A TCP port that listens. *out gets the port where `at` has 0. */
int gw_socket_listen(const gw_endpoint *at, uint16_t *out);
/* A connection without delay for small packets, or -1: nobody is waiting. */
int gw_socket_accept(int listening, gw_endpoint *from);
/* Begins to connect, from the interface `bind` ("" or NULL: any); gw_socket_settled() tells when it is done.
 */
int gw_socket_connect(const gw_endpoint *to, const char *bind);
/* 1 when the connection stands; 0 not yet; -1 it failed, errno says how. */
int gw_socket_settled(int connecting);

/* A UDP socket bound to a port, for datagrams with the time of their arrival; a multicast `group` is joined
 * on the interface of `at`. */
int gw_socket_datagrams(const gw_endpoint *at, const char *group, uint16_t *out);
/* The address by which this machine speaks to `to`. */
int gw_socket_own_address(const gw_endpoint *to, char address[16]);

/* As recv() with MSG_DONTWAIT, and with the time (ns, gw_now_ns clock) at which the kernel had it, at most
 * `now`; `now` where the kernel does not say; of a stream, that of the last bytes. from may be NULL. size +
 * 1: a datagram that is longer. */
ssize_t gw_socket_receive(int socket, void *bytes, size_t size, int64_t now, int64_t *arrival,
                          gw_endpoint *from);
/* As send() and sendto() without waiting; 0 when there is no room now, -1 when the other end is gone. */
ssize_t gw_socket_send(int socket, const void *bytes, size_t size);
ssize_t gw_socket_send_to(int socket, const gw_endpoint *to, const void *bytes, size_t size);

/* Closes it if it is one, and says so. */
void gw_socket_close(int *socket);

#endif

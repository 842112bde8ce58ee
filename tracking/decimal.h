/* Decimal numbers in text of given length, with a dot whatever the locale is. Any thread. */
#ifndef GW_TRACKING_DECIMAL_H
#define GW_TRACKING_DECIMAL_H

#include <stddef.h>

/* Reads [sign] digits [. digits] [e [sign] digits] at *from, before `end`, and moves *from behind it. 0, and
 * *from stays: it is none, or longer than 40 digits. Exact for up to 15 digits. */
int gw_decimal_read(const char **from, const char *end, double *out);

/* Writes with so many decimals (0 to 6), rounded; |value| below 1e12. Returns the characters. */
size_t gw_decimal_write(double value, int decimals, char text[32]);

#endif

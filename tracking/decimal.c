#include "tracking/decimal.h"

#include <inttypes.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>

static int is_digit(const char *at, const char *end) {
    return at < end && *at >= '0' && *at <= '9';
}

/* 1 and the sign, which may be missing. */
static double take_sign(const char **at, const char *end) {
    const char sign = *at < end ? **at : '\0';
    *at += sign == '-' || sign == '+';
    return sign == '-' ? -1 : 1;
}

/* Digits into *value while they fit; *dropped counts those that do not. */
static int take_digits(const char **at, const char *end, uint64_t *value, int *dropped) {
    int count = 0;
    for (; is_digit(*at, end); ++*at, count++) {
        if (*value < 100000000000000000u)
            *value = 10 * *value + (uint64_t)(**at - '0');
        else
            ++*dropped;
    }
    return count;
}

static double power_of_ten(int exponent) {
    double power = 1;
    for (; exponent > 0; exponent--)
        power *= 10; /* exact up to 22 */
    return power;
}

int gw_decimal_read(const char **from, const char *end, double *out) {
    const char *at = *from;
    const double sign = take_sign(&at, end);
    uint64_t value = 0, power = 0;
    int whole_dropped = 0, decimals_dropped = 0, ignored = 0;
    const int whole = take_digits(&at, end, &value, &whole_dropped);
    int decimals = 0, exponent = 0;
    if (at < end && *at == '.') {
        at++;
        decimals = take_digits(&at, end, &value, &decimals_dropped);
    }
    if (whole + decimals == 0 || whole + decimals > 40)
        return 0;
    if (at < end && (*at == 'e' || *at == 'E')) {
        const char *mark = at++;
        const double direction = take_sign(&at, end);
        if (take_digits(&at, end, &power, &ignored) == 0)
            at = mark;
        else
            exponent = (int)direction * (int)(power < 400 ? power : 400);
    }
    exponent += whole_dropped - (decimals - decimals_dropped);
    const double magnitude =
        exponent < 0 ? (double)value / power_of_ten(-exponent) : (double)value * power_of_ten(exponent);
    *out = sign * magnitude;
    *from = at;
    return 1;
}

size_t gw_decimal_write(double value, int decimals, char text[32]) {
    const double scale = power_of_ten(decimals);
    const int64_t scaled = llround(fabs(value) * scale), step = (int64_t)scale;
    const char *sign = value < 0 && scaled > 0 ? "-" : "";
    if (decimals == 0)
        return (size_t)snprintf(text, 32, "%s%" PRId64, sign, scaled);
    return (size_t)snprintf(text, 32, "%s%" PRId64 ".%0*" PRId64, sign, scaled / step, decimals,
                            scaled % step);
}

/* Between the parts of the site reader (wall/site_*.c); nobody else includes it. One thread per source. */
#ifndef GW_WALL_SITE_INTERNAL_H
#define GW_WALL_SITE_INTERNAL_H

#include "base/yaml.h"
#include "wall/site.h"

#include <stddef.h>
#include <stdio.h>

#define GW_COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* The document being read, and where in it the parts of the site were said, for messages. */
typedef struct gw_site_source {
    const gw_yaml_node *root;
    const gw_yaml_node *tiles[GW_MAXIMUM_TILES];  /* the tile's own entry, or the generator's */
    const gw_yaml_node *panels[GW_MAXIMUM_TILES]; /* the innermost map of panel keys, or the tile's entry */
    gw_site_notes *notes;
} gw_site_source;

/* A map that has only the keys `names`. key is what messages call the map. */
gw_code gw_site_map(const gw_yaml_node *node, const char *key, const char *const *names, size_t count,
                    gw_error *error);
/* The value of a key that must be there. */
gw_code gw_site_require(const gw_yaml_node *map, const char *key, const gw_yaml_node **out, gw_error *error);
/* A number, if the key is there; else *out stays. */
gw_code gw_site_number(const gw_yaml_node *map, const char *key, double minimum, double maximum, double *out,
                       gw_error *error);
/* A text of 1 to size - 1 characters, letters, digits and `others`, if the key is there. */
gw_code gw_site_text(const gw_yaml_node *map, const char *key, const char *others, size_t size, char *out,
                     gw_error *error);

/* [across, down] in whole pixels, which must be there. */
gw_code gw_site_pixels(const gw_yaml_node *map, const char *key, uint32_t minimum, uint32_t out[2],
                       gw_error *error);
/* The pixels of a tile: what `panels` says of it, else key pixels of its map, else what `panel` says for all.
 * name is NULL for what a generator's tiles have in common. */
gw_code gw_site_pixels_of(const gw_site_source *source, const gw_yaml_node *map, const char *name,
                          uint32_t out[2], gw_error *error);
/* Gives tiles of a grid, from `first` on, the pixels that `panels` says of them; the others make room. */
gw_code gw_site_refit(const gw_site_source *source, uint32_t columns, uint32_t rows, uint32_t first,
                      gw_layout *layout, uint32_t framed_end[2], gw_error *error);
/* [x, y, z] in mm. */
gw_code gw_site_point(const gw_yaml_node *node, const char *key, double out[3], gw_error *error);
/* The numeric address of an interface, if the key is there; else "". */
gw_code gw_site_address(const gw_yaml_node *map, const char *key, char out[64], gw_error *error);
/* Key name, which must be there: of a tile or a wall. */
gw_code gw_site_name(const gw_yaml_node *map, char out[32], gw_error *error);

/* A warning at a node; beyond the list's end it is only counted. */
void gw_site_note(gw_site_source *source, const gw_yaml_node *node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Tiles measured one by one. size: key framed_size of the site, or NULL. */
gw_code gw_site_read_tiles(gw_site_source *source, const gw_yaml_node *list, const gw_yaml_node *size,
                           gw_layout *out, gw_error *error);

/* Tiles by a generator: kind is "grid", "curve" or "walls", node its value. */
gw_code gw_site_generate(gw_site_source *source, const char *kind, const gw_yaml_node *node, gw_layout *out,
                         gw_error *error);

/* What only the whole site shows: tiles in each other's way, an eye behind a panel, sizes that cannot be mm,
 * panels driven twice. The last step of reading; gw_site_check_space is its first part. */
gw_code gw_site_check(gw_site_source *source, const gw_site *site, gw_error *error);

gw_code gw_site_check_space(gw_site_source *source, const gw_site *site, gw_error *error);

/* Keys tracker and trackers of the site. */
gw_code gw_site_read_trackers(gw_site_source *source, gw_site *site, gw_error *error);
enum { GW_HIGHEST_SENSOR = 999 }; /* that a site can name */

/* Writes what differs, and what is: parts of gw_site_compare and gw_site_write. */
void gw_site_change(gw_site_changes *out, int restart, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void gw_site_compare_trackers(gw_site_changes *out, const gw_site *before, const gw_site *after);
void gw_site_put_number(FILE *out, double value); /* the shortest decimal that is read as the same double */
void gw_site_put_numbers(FILE *out, const double *values, int count);
void gw_site_put_trackers(FILE *out, const gw_site *site);

/* Keys panel, panels and hosts of the site, and the key panel of tiles and walls. After the layout. */
gw_code gw_site_read_panels(gw_site_source *source, gw_site *site, gw_error *error);

#endif

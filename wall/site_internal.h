/* Between the parts of the site reader (wall/site_*.c); nobody else includes it. One thread per source. */
#ifndef GW_WALL_SITE_INTERNAL_H
#define GW_WALL_SITE_INTERNAL_H

#include "base/yaml.h"
#include "wall/site.h"

#include <stddef.h>

#define GW_COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* The document being read, and where in it the parts of the site were said, for messages. */
typedef struct gw_site_source {
    const gw_yaml_node *root;
    const gw_yaml_node *tiles[GW_MAXIMUM_TILES];  /* the tile's own entry, or the generator's */
    const gw_yaml_node *panels[GW_MAXIMUM_TILES]; /* the innermost map of panel keys, or the tile's entry */
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

/* Keys panel, panels and hosts of the site, and the key panel of measured tiles. After the layout. */
gw_code gw_site_read_panels(gw_site_source *source, gw_site *site, gw_error *error);

#endif

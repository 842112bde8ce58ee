/* docs/settings.md, written from the table of settings. Any thread. */
#ifndef GW_BASE_SETTINGS_PAGE_H
#define GW_BASE_SETTINGS_PAGE_H

/* The whole page; free() it. NULL when memory is out. */
char *gw_settings_page(void);

#endif

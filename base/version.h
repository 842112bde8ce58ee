/* The program's version, as --version, reports and caches state it. */
#ifndef GW_BASE_VERSION_H
#define GW_BASE_VERSION_H

#define GW_VERSION "0.1.0"

#endif

/* The bytes that the import child sends: a gw_source_model, little-endian, one section after the other. The
 * reader trusts nothing: every count is bounded by the bytes that remain, every value is checked. Any thread.
 */
#ifndef GW_BUILD_IMPORT_STREAM_H
#define GW_BUILD_IMPORT_STREAM_H

#include "base/status.h"
#include "build/source_model.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { GW_MODEL_STREAM_HEADER = 24 }; /* bytes: magic (8), version, zero, total size (8) */

/* Writes the model to an open file (a pipe); GW_NO_OUTPUT when that fails. */
gw_code gw_model_stream_write(FILE *file, const gw_source_model *model, gw_error *error);

/* Total size told by the first GW_MODEL_STREAM_HEADER bytes, 0 when they are not such a header. */
uint64_t gw_model_stream_size(const void *header);

/* Makes a model of the bytes; GW_BAD_INPUT says where they are wrong. */
gw_code gw_model_stream_read(const void *data, size_t size, gw_source_model **out, gw_error *error);

#endif

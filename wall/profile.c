#include "wall/profile.h"

#include "base/embedded.h"
#include "base/file.h"
#include "base/yaml.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gw_profile_init(gw_profile *profile) {
    *profile = (gw_profile){.name = "default"};
    gw_settings_init(&profile->settings);
}

/* --- reading */

static gw_code take_text(const gw_yaml_node *map, const char *key, char *out, size_t size, gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    const char *text = node ? gw_yaml_text(node) : NULL;
    if (!node)
        return GW_OK;
    if (gw_yaml_expect(node, GW_YAML_SCALAR, key, error))
        return error->code;
    if (!text || strlen(text) >= size)
        return gw_yaml_fail(node, error, "key '%s': longer than %zu characters", key, size - 1);
    snprintf(out, size, "%s", text);
    return GW_OK;
}

static gw_code take_settings(const gw_yaml_node *map, gw_settings *settings, gw_error *error) {
    gw_code code = gw_yaml_expect(map, GW_YAML_MAP, "settings", error);
    for (size_t i = 0; !code && i < gw_yaml_count(map); i++) {
        const char *name = gw_yaml_key(map, i);
        const gw_yaml_node *node = gw_yaml_value(map, i);
        const char *text = gw_yaml_text(node);
        char assignment[192];
        code = gw_yaml_expect(node, GW_YAML_SCALAR, name, error);
        if (code)
            return code;
        gw_error wrong = {0};
        const int length = snprintf(assignment, sizeof assignment, "%s=%s", name, text ? text : "");
        if (length >= (int)sizeof assignment)
            return gw_yaml_fail(node, error, "key 'settings': '%.40s' is too long", name);
        if (gw_settings_assign(settings, assignment, &wrong))
            return gw_yaml_fail(node, error, "key 'settings': %s", wrong.text);
    }
    return code;
}

static gw_code take_figures(const gw_yaml_node *map, gw_profile *out, gw_error *error) {
    gw_code code = gw_yaml_expect(map, GW_YAML_MAP, "measured", error);
    if (!code && gw_yaml_count(map) > GW_PROFILE_FIGURES)
        return gw_yaml_fail(map, error, "key 'measured': %zu figures; %d are the most", gw_yaml_count(map),
                            GW_PROFILE_FIGURES);
    for (size_t i = 0; !code && i < gw_yaml_count(map); i++) {
        const char *name = gw_yaml_key(map, i);
        code = gw_yaml_number(gw_yaml_value(map, i), name, -1e18, 1e18, &out->figures[i].value, error);
        snprintf(out->figures[i].name, sizeof out->figures[i].name, "%s", name);
        out->figure_count = i + 1;
    }
    return code;
}

static gw_code take_root(const gw_yaml_node *root, gw_settings *settings, gw_profile *out, gw_error *error) {
    static const char *const keys[] = {"profile", "about", "measured_by", "measured", "settings"};
    const gw_yaml_node *named, *assigned, *measured;
    gw_code code = gw_yaml_expect(root, GW_YAML_MAP, "profile", error);
    if (!code)
        code = gw_yaml_check_keys(root, keys, sizeof keys / sizeof *keys, error);
    if (code)
        return code;
    named = gw_yaml_find(root, "profile");
    assigned = gw_yaml_find(root, "settings");
    measured = gw_yaml_find(root, "measured");
    if (!named || !assigned)
        return gw_yaml_fail(root, error, "key '%s' is missing: a profile has a name and settings",
                            named ? "settings" : "profile");
    code = take_text(root, "profile", out->name, sizeof out->name, error);
    if (!code)
        code = take_text(root, "about", out->about, sizeof out->about, error);
    if (!code)
        code = take_text(root, "measured_by", out->measured_by, sizeof out->measured_by, error);
    if (!code && measured)
        code = take_figures(measured, out, error);
    return code ? code : take_settings(assigned, settings, error);
}

static gw_code take_document(const gw_yaml *document, gw_settings *settings, gw_profile *out,
                             gw_error *error) {
    gw_settings taken = *settings;
    gw_profile_init(out);
    gw_code code = take_root(gw_yaml_root(document), &taken, out, error);
    if (!code)
        out->settings = *settings = taken;
    return code;
}

gw_code gw_profile_parse(const char *text, size_t size, const char *name, gw_settings *settings,
                         gw_profile *out, gw_error *error) {
    gw_yaml *document = NULL;
    gw_code code = gw_yaml_parse(text, size, name, &document, error);
    if (!code)
        code = take_document(document, settings, out, error);
    gw_yaml_destroy(&document);
    return code;
}

static const gw_embedded_file *find_embedded(const char *word) {
    char name[128];
    snprintf(name, sizeof name, "configs/profiles/%.64s.yaml", word);
    return gw_embedded_find(name);
}

gw_code gw_profile_apply(const char *word, gw_settings *settings, gw_profile *out, gw_error *error) {
    const gw_embedded_file *embedded = find_embedded(word);
    if (embedded && !gw_file_exists(word))
        return gw_profile_parse((const char *)embedded->data, embedded->size, word, settings, out, error);
    if (!gw_file_exists(word) && !strchr(word, '/') && !strchr(word, '.'))
        return gw_fail(error, GW_BAD_INPUT,
                       "'%.80s' is neither a file nor one of draft, show, study and exact", word);
    gw_yaml *document = NULL;
    gw_code code = gw_yaml_load(word, &document, error);
    if (!code)
        code = take_document(document, settings, out, error);
    gw_yaml_destroy(&document);
    snprintf(out->file, sizeof out->file, "%.255s", word);
    return code;
}

/* --- writing */

/* As YAML takes it between double quotes. */
static void put_quoted(FILE *file, const char *text) {
    fputc('"', file);
    for (const char *c = text; *c; c++) {
        if (*c == '"' || *c == '\\')
            fputc('\\', file);
        fputc((unsigned char)*c < ' ' ? ' ' : *c, file);
    }
    fputs("\"\n", file);
}

gw_code gw_profile_write(const char *path, const gw_profile *profile, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        return gw_fail(error, GW_MACHINE, "memory is out while writing a profile");
    fputs("profile: ", file);
    put_quoted(file, profile->name);
    fputs("about: ", file);
    put_quoted(file, profile->about);
    fputs("measured_by: ", file);
    put_quoted(file, profile->measured_by);
    fputs(profile->figure_count ? "measured:\n" : "measured: {}\n", file);
    for (size_t i = 0; i < profile->figure_count; i++)
        fprintf(file, "  %s: %.6g\n", profile->figures[i].name, profile->figures[i].value);
    size_t written = 0;
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        char value[64];
        gw_setting_text(&profile->settings, row, value);
        if (row->stage != GW_SETTING_TRACK && gw_setting_value(&profile->settings, row) != row->initial)
            fprintf(file, "%s  %s: %s\n", written++ ? "" : "settings:\n", row->name, value);
    }
    fputs(written ? "" : "settings: {}\n", file);
    fclose(file);
    gw_code code = gw_file_write(path, text, size, error);
    free(text);
    return code;
}

/* --- reports */

json_t *gw_profile_json(const gw_profile *profile, const gw_settings *settings) {
    json_t *changed = json_array(), *figures = json_object();
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        if (gw_setting_value(&profile->settings, row) != gw_setting_value(settings, row))
            json_array_append_new(changed, json_string(row->name));
    }
    for (size_t i = 0; i < profile->figure_count; i++)
        json_object_set_new(figures, profile->figures[i].name, json_real(profile->figures[i].value));
    json_t *file = profile->file[0] ? json_string(profile->file) : NULL,
           *by = profile->measured_by[0] ? json_string(profile->measured_by) : NULL;
    return json_pack("{s:s, s:o, s:o, s:o, s:o}", "name", profile->name, "file", file ? file : json_null(),
                     "measured_by", by ? by : json_null(), "measured", figures, "changed", changed);
}

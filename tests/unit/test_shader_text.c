/* Assembling shaders: each include once, conditions respected, line numbers kept, messages mapped back. */
#include "tests/support/check.h"

#include "base/embedded.h"
#include "base/file.h"
#include "base/gl.h"
#include "base/shader_text.h"

static void put(const char *name, const char *text) {
    char path[512];
    gw_error error = {0};
    scratch_path(path, name);
    char *folder = gw_path_folder(path);
    assert_int_equal(gw_make_directories(folder, &error), GW_OK);
    free(folder);
    assert_int_equal(gw_file_write(path, text, strlen(text), &error), GW_OK);
}

static gw_code assemble(const char *name, const char *defines, gw_shader_text *out, gw_error *error) {
    char folder[512];
    return gw_shader_text_create(scratch_path(folder, "shaders"), name, defines, out, error);
}

static size_t occurrences(const char *text, const char *part) {
    size_t count = 0;
    for (text = strstr(text, part); text; text = strstr(text + 1, part)) {
        count++;
    }
    return count;
}

static void an_include_is_taken_once(void **state) {
    (void)state;
    put("shaders/a.comp", "#include \"lib/b.glsl\"\n#include \"lib/c.glsl\"\nint last = A;\n");
    put("shaders/lib/b.glsl", "#include \"lib/c.glsl\"\nint in_b;\n");
    put("shaders/lib/c.glsl", "int in_c;");
    gw_shader_text text;
    check_ok(assemble("a.comp", "#define A 1\n", &text, &error));
    assert_memory_equal(text.text, "#version 450 core\n#define A 1\n", 30);
    assert_int_equal(occurrences(text.text, "int in_b;"), 1);
    assert_int_equal(occurrences(text.text, "int in_c;"), 1);
    assert_true(strstr(text.text, "int in_c;") < strstr(text.text, "int in_b;"));
    assert_true(strstr(text.text, "int in_b;") < strstr(text.text, "int last = A;"));
    assert_int_equal(text.file_count, 3);
    assert_string_equal(text.files[0], "shaders/a.comp");
    assert_string_equal(text.files[1], "shaders/lib/b.glsl");
    gw_shader_text_finish(&text);
    assert_null(text.text);
}

/* Kernels that differ in nothing have one text. */
static void defines_that_nothing_reads_are_left_out(void **state) {
    (void)state;
    put("shaders/a.comp", "#include \"c.glsl\"\n#ifdef ASKED\nint a; // UNSAID\n#endif\nint PART_OF_IT;\n");
    put("shaders/c.glsl", "int in_c = VALUE; /* SAID */\nint MY_PART;\n");
    gw_shader_text text;
    check_ok(assemble("a.comp",
                      "#define ASKED 1\n#define UNSAID 1\n#define VALUE 3u\n#define PART 1\n#define SAID 1\n"
                      "#define NEVER 1\n",
                      &text, &error));
    static const char head[] =
        "#version 450 core\n#define ASKED 1\n#define VALUE 3u\n#define SAID 1\n\n#line 1\n";
    assert_memory_equal(text.text, head, sizeof head - 1);
    gw_shader_text_finish(&text);
    put("shaders/a.comp", "");
    check_ok(assemble("a.comp", "#define A 1\n", &text, &error));
    assert_string_equal(text.text, "#version 450 core\n\n#line 1\n");
    gw_shader_text_finish(&text);
}

/* An include inside an #if that is not taken must not hide a later one outside. */
static void a_conditional_include_does_not_count_as_taken(void **state) {
    (void)state;
    put("shaders/a.comp",
        "#ifdef NEVER\n#include \"c.glsl\"\n#endif\n#include \"c.glsl\"\n#include \"c.glsl\"\n");
    put("shaders/c.glsl", "int in_c;\n");
    gw_shader_text text;
    check_ok(assemble("a.comp", NULL, &text, &error));
    assert_int_equal(occurrences(text.text, "int in_c;"), 2);
    assert_int_equal(occurrences(text.text, "#ifndef GW_FILE_1"), 2);
    gw_shader_text_finish(&text);
}

static void lines_after_an_include_keep_their_numbers(void **state) {
    (void)state;
    put("shaders/a.comp", "int one;\n#include \"c.glsl\"\nint three;\n");
    put("shaders/c.glsl", "int x;\nint y;\n");
    gw_shader_text text;
    check_ok(assemble("a.comp", NULL, &text, &error));
    assert_non_null(strstr(text.text, "#line 1\nint one;\n"));
    assert_non_null(strstr(text.text, "#line 100001\nint x;\n"));
    assert_non_null(strstr(text.text, "#line 3\nint three;\n"));
    gw_shader_text_finish(&text);
}

static void bad_includes_name_file_and_line(void **state) {
    (void)state;
    gw_shader_text text;
    put("shaders/a.comp", "\n#include \"missing.glsl\"\n");
    check_fails(assemble("a.comp", NULL, &text, &error), GW_BAD_INPUT, "shaders/a.comp:2: ");
    put("shaders/a.comp", "\n\n#include missing\n");
    check_fails(assemble("a.comp", NULL, &text, &error), GW_BAD_INPUT,
                "shaders/a.comp:3: #include needs a name in double quotes");
    put("shaders/a.comp", "#include \"../../etc/passwd\"\n");
    check_fails(assemble("a.comp", NULL, &text, &error), GW_BAD_INPUT, "is no name of a shader");
    put("shaders/a.comp", "#include \"b.glsl\"\n");
    put("shaders/b.glsl", "int b;\n#include \"a.comp\"\n");
    check_fails(assemble("a.comp", NULL, &text, &error), GW_BAD_INPUT,
                "shaders/b.glsl:2: including shaders/a.comp");
    put("shaders/a.comp", "#include \"a.comp\"\n");
    check_fails(assemble("a.comp", NULL, &text, &error), GW_BAD_INPUT, "shaders/a.comp:1: including");
    put("shaders/a.comp", "#if 1\nint a;\n");
    check_fails(assemble("a.comp", NULL, &text, &error), GW_BAD_INPUT,
                "shaders/a.comp: #if and #endif do not pair up");
    check_fails(assemble("none.comp", NULL, &text, &error), GW_BAD_INPUT, "none.comp");
    check_fails(gw_shader_text_create(NULL, "none.comp", NULL, &text, &error), GW_BAD_INPUT,
                "shaders/none.comp: there is no such shader in the program");
}

static void messages_are_mapped_to_files(void **state) {
    (void)state;
    put("shaders/a.comp", "#include \"c.glsl\"\n");
    put("shaders/c.glsl", "int x;\n");
    gw_shader_text text;
    check_ok(assemble("a.comp", NULL, &text, &error));
    char *message = gw_shader_text_message(
        &text, "0:100001(1): warning: error may be unset\n0:100023(10): error: x\n0(5) : error C1\n"
               "WARNING: 0:1: w\nERROR: 0:100002: 'y'\n0:900001: z\nplain\n");
    assert_string_equal(message, "shaders/c.glsl:23(10): error: x\nshaders/a.comp:5) : error C1\n"
                                 "shaders/c.glsl:2: 'y'\nshaders/c.glsl:1(1): warning: error may be unset\n"
                                 "shaders/a.comp:1: w\n0:900001: z\nplain");
    free(message);
    gw_shader_text_finish(&text);
}

static void embedded_files_are_found(void **state) {
    (void)state;
    for (size_t i = 0; i < gw_embedded_count; i++) {
        const gw_embedded_file *file = gw_embedded_find(gw_embedded_files[i].name);
        assert_ptr_equal(file, &gw_embedded_files[i]);
        gw_bytes bytes;
        check_ok(gw_file_read(file->name, 1 << 24, &bytes, &error));
        assert_int_equal(bytes.size, file->size);
        assert_memory_equal(bytes.data, file->data, file->size + 1);
        gw_bytes_finish(&bytes);
    }
    assert_non_null(gw_embedded_find("shaders/common/shared.h"));
    assert_null(gw_embedded_find("shaders/common/none.h"));
    assert_null(gw_embedded_find(""));
}

/* Else a driver that passes the check of gw_gl_create would fail at a frame's first buffer. */
static void no_buffer_lies_beyond_the_bindings_that_are_asked_for(void **state) {
    (void)state;
    static const char words[] = "layout(std430, binding = ";
    int most = 0;
    for (size_t i = 0; i < gw_embedded_count; i++)
        for (const char *at = strstr((const char *)gw_embedded_files[i].data, words); at;
             at = strstr(at + 1, words)) {
            const int binding = atoi(at + strlen(words));
            most = binding > most ? binding : most;
        }
    assert_int_equal(most + 1, GW_GL_STORAGE_BINDINGS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_include_is_taken_once),
        cmocka_unit_test(defines_that_nothing_reads_are_left_out),
        cmocka_unit_test(a_conditional_include_does_not_count_as_taken),
        cmocka_unit_test(lines_after_an_include_keep_their_numbers),
        cmocka_unit_test(bad_includes_name_file_and_line),
        cmocka_unit_test(messages_are_mapped_to_files),
        cmocka_unit_test(embedded_files_are_found),
        cmocka_unit_test(no_buffer_lies_beyond_the_bindings_that_are_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

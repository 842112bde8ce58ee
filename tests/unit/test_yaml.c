/* YAML: the tree, typed access, and errors that name file, line, key and value. */
#include "tests/support/check.h"

#include "base/yaml.h"

static gw_code parse(const char *text, gw_yaml **out, gw_error *error) {
    return gw_yaml_parse(text, strlen(text), "x.yaml", out, error);
}

static void tree_has_kinds_values_and_lines(void **state) {
    (void)state;
    gw_yaml *document = NULL;
    check_ok(parse("# a comment\n"
                   "name: \"a wall\"\n"
                   "size: [3840, 2160]\n"
                   "tiles:\n"
                   "  - {host: left}\n"
                   "  - host: right\n"
                   "    rank: 2\n",
                   &document, &error));
    const gw_yaml_node *root = gw_yaml_root(document);
    assert_int_equal(gw_yaml_node_kind(root), GW_YAML_MAP);
    assert_int_equal(gw_yaml_count(root), 3);
    assert_string_equal(gw_yaml_key(root, 1), "size");
    assert_string_equal(gw_yaml_text(gw_yaml_find(root, "name")), "a wall");
    assert_int_equal(gw_yaml_node_line(gw_yaml_find(root, "name")), 2);
    const gw_yaml_node *tiles = gw_yaml_find(root, "tiles");
    assert_ptr_equal(tiles, gw_yaml_value(root, 2));
    assert_int_equal(gw_yaml_node_kind(tiles), GW_YAML_LIST);
    assert_int_equal(gw_yaml_count(tiles), 2);
    assert_int_equal(gw_yaml_node_line(gw_yaml_item(tiles, 1)), 6);
    long rank = 0;
    check_ok(gw_yaml_integer(gw_yaml_find(gw_yaml_item(tiles, 1), "rank"), "rank", 0, 9, &rank, &error));
    assert_int_equal(rank, 2);
    assert_null(gw_yaml_find(root, "absent"));
    assert_null(gw_yaml_item(tiles, 2));
    assert_null(gw_yaml_find(tiles, "name"));
    gw_yaml_destroy(&document);
    assert_null(document);
    gw_yaml_destroy(&document);
}

/* One bad document and the sentence that it must give. */
typedef struct bad_text {
    const char *text, *message;
} bad_text;

static void syntax_errors_name_their_line(void **state) {
    (void)state;
    static const bad_text table[] = {
        {"", "x.yaml:1: there is nothing in it"},
        {"# only a comment\n", "there is nothing in it"},
        {"a: 1\nb: [1, 2\nc: 3\n", "x.yaml:3: not valid YAML"},
        {"a: 1\n\tb: 2\n", "x.yaml:2: not valid YAML"},
        {"a: 1\nb: 2\na: 3\n", "x.yaml:3: key 'a' is given twice; the first is in line 1"},
        {"z: {p: 1,\n q: 2,\n p: 3}\n", "x.yaml:3: key 'p' is given twice; the first is in line 1"},
        {"a: 1\n---\nb: 2\n", "x.yaml:2: a second document begins"},
        {"a: &x 1\nb: *x\n", "x.yaml:1: anchors and aliases"},
        {"b: *x\n", "x.yaml:1: anchors and aliases"},
        {"a: 1\nb: &list [1]\n", "x.yaml:2: anchors and aliases"},
        {"a:\n  - !!python/object 1\n", "x.yaml:2: tags (!) are not supported"},
        {"? [1, 2]\n: 3\n", "x.yaml:1: a key must be a plain word"},
        {"a: \"x\\0y\"\n", "x.yaml:1: a text must not contain a zero byte"},
        {"a: \xff\xfe\n", "x.yaml: not valid UTF-8"},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        gw_yaml *document = NULL;
        check_fails(parse(table[i].text, &document, &error), GW_BAD_INPUT, table[i].message);
        assert_null(document);
    }
}

static void values_are_checked(void **state) {
    (void)state;
    gw_yaml *document = NULL;
    check_ok(
        parse("n: 12.5\nword: hello\nquoted: \"3\"\nlist: [1, 2, 3]\nbad: [1, x, 3]\nhex: 0x10\nbig: 1e999\n"
              "on: on\nno: false\ndeep: {a: 1}\nlong: 99999999999999999999\nnan: .nan\nempty:\n",
              &document, &error));
    const gw_yaml_node *root = gw_yaml_root(document);
    double number = 0, numbers[3];
    long whole = 0;
    int truth = -1;
#define AT(key) gw_yaml_find(root, key), key
    check_ok(gw_yaml_number(AT("n"), 0, 20, &number, &error));
    assert_true(number == 12.5);
    check_fails(gw_yaml_number(AT("n"), 0, 10, &number, &error), GW_BAD_INPUT,
                "x.yaml:1: key 'n': 12.5 is outside 0 to 10");
    check_fails(gw_yaml_number(AT("word"), 0, 10, &number, &error), GW_BAD_INPUT,
                "x.yaml:2: key 'word': expected a number, found 'hello'");
    check_fails(gw_yaml_number(AT("quoted"), 0, 10, &number, &error), GW_BAD_INPUT, "x.yaml:3: key 'quoted'");
    check_fails(gw_yaml_number(AT("list"), 0, 10, &number, &error), GW_BAD_INPUT,
                "x.yaml:4: key 'list': expected a number, found a list");
    check_fails(gw_yaml_number(AT("hex"), 0, 100, &number, &error), GW_BAD_INPUT, "found '0x10'");
    check_fails(gw_yaml_number(AT("big"), 0, 100, &number, &error), GW_BAD_INPUT, "found '1e999'");
    check_fails(gw_yaml_number(AT("nan"), 0, 100, &number, &error), GW_BAD_INPUT, "found '.nan'");
    check_fails(gw_yaml_number(AT("empty"), 0, 100, &number, &error), GW_BAD_INPUT, "found ''");
    check_fails(gw_yaml_integer(AT("n"), 0, 20, &whole, &error), GW_BAD_INPUT,
                "expected a whole number, found '12.5'");
    check_fails(gw_yaml_integer(AT("long"), 0, 20, &whole, &error), GW_BAD_INPUT, "is outside 0 to 20");
    check_ok(gw_yaml_numbers(AT("list"), 3, numbers, &error));
    assert_true(numbers[0] == 1 && numbers[1] == 2 && numbers[2] == 3);
    check_fails(gw_yaml_numbers(AT("list"), 2, numbers, &error), GW_BAD_INPUT,
                "x.yaml:4: key 'list': expected 2 numbers, found 3");
    check_fails(gw_yaml_numbers(AT("bad"), 3, numbers, &error), GW_BAD_INPUT,
                "x.yaml:5: key 'bad': item 2: expected a number, found 'x'");
    check_fails(gw_yaml_numbers(AT("n"), 3, numbers, &error), GW_BAD_INPUT, "expected a list of 3 numbers");
    check_ok(gw_yaml_boolean(AT("on"), &truth, &error));
    assert_int_equal(truth, 1);
    check_ok(gw_yaml_boolean(AT("no"), &truth, &error));
    assert_int_equal(truth, 0);
    check_fails(gw_yaml_boolean(AT("word"), &truth, &error), GW_BAD_INPUT,
                "expected true or false, found 'hello'");
    check_ok(gw_yaml_expect(gw_yaml_find(root, "deep"), GW_YAML_MAP, "deep", &error));
    check_fails(gw_yaml_expect(gw_yaml_find(root, "deep"), GW_YAML_LIST, "deep", &error), GW_BAD_INPUT,
                "x.yaml:10: key 'deep': expected a list, found a map");
#undef AT
    gw_yaml_destroy(&document);
}

static void unknown_keys_name_the_nearest(void **state) {
    (void)state;
    static const char *const known[] = {"models", "lights", "viewpoints"};
    gw_yaml *document = NULL;
    check_ok(parse("models: 1\nligths: 2\n", &document, &error));
    check_fails(gw_yaml_check_keys(gw_yaml_root(document), known, 3, &error), GW_BAD_INPUT,
                "x.yaml:2: key 'ligths' is unknown; did you mean 'lights'?");
    gw_yaml_destroy(&document);
    check_ok(parse("models: 1\n\nweather: 2\n", &document, &error));
    check_fails(gw_yaml_check_keys(gw_yaml_root(document), known, 3, &error), GW_BAD_INPUT,
                "x.yaml:3: key 'weather' is unknown here; known are: models, lights, viewpoints");
    /* So many that the sentence would be a page. */
    const char *many[100];
    for (size_t i = 0; i < 100; i++)
        many[i] = "a_name_of_twenty_one_";
    check_fails(gw_yaml_check_keys(gw_yaml_root(document), many, 100, &error), GW_BAD_INPUT,
                "a_name_of_twenty_one_, ...");
    gw_yaml_destroy(&document);
    check_ok(parse("[1]\n", &document, &error));
    check_fails(gw_yaml_check_keys(gw_yaml_root(document), known, 3, &error), GW_BAD_INPUT, "expected a map");
    gw_yaml_destroy(&document);
}

static void hostile_nesting_ends_at_once(void **state) {
    (void)state;
    size_t depth = 200000;
    char *text = malloc(depth + 1);
    assert_non_null(text);
    memset(text, '[', depth);
    text[depth] = '\0';
    gw_yaml *document = NULL;
    check_fails(parse(text, &document, &error), GW_BAD_INPUT, "x.yaml:1: nested deeper than 64 levels");
    memset(text, '[', 64);
    memset(text + 64, ']', 64);
    text[128] = '\0';
    check_ok(parse(text, &document, &error));
    gw_yaml_destroy(&document);
    free(text);
}

static void large_files_are_bounded(void **state) {
    (void)state;
    size_t size = (1 << 20) + 1;
    char *text = malloc(size + 1);
    assert_non_null(text);
    memset(text, ' ', size);
    text[size] = '\0';
    gw_yaml *document = NULL;
    check_fails(parse(text, &document, &error), GW_BAD_INPUT, "larger than the limit of 1048576");
    /* A map of as many keys as fit, the last one repeated. */
    size_t length = 0;
    int key = 0;
    while (length < size - 40) {
        length += (size_t)snprintf(text + length, 20, "k%d: 1\n", key++);
    }
    snprintf(text + length, 20, "k7: 1\n");
    char message[80];
    snprintf(message, sizeof message, "x.yaml:%d: key 'k7' is given twice; the first is in line 8", key + 1);
    check_fails(parse(text, &document, &error), GW_BAD_INPUT, message);
    free(text);
}

static void cut_documents_never_crash(void **state) {
    (void)state;
    static const char text[] =
        "a: [1, {b: \"x y\", c: 'z'}]\nd:\n  - >\n    folded\n  - |\n    block\ne: !t &q *r\n";
    for (size_t cut = 0; cut < sizeof text; cut++) {
        for (int byte = 0; byte < 3; byte++) {
            char bent[sizeof text];
            memcpy(bent, text, sizeof text);
            bent[cut] = "\x80]\n"[byte];
            gw_yaml *document = NULL;
            gw_error error = {0};
            gw_code code = gw_yaml_parse(bent, cut + 1, "x.yaml", &document, &error);
            assert_true(code == GW_OK ? document != NULL : document == NULL && error.text[0]);
            gw_yaml_destroy(&document);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tree_has_kinds_values_and_lines),
        cmocka_unit_test(syntax_errors_name_their_line),
        cmocka_unit_test(values_are_checked),
        cmocka_unit_test(unknown_keys_name_the_nearest),
        cmocka_unit_test(hostile_nesting_ends_at_once),
        cmocka_unit_test(large_files_are_bounded),
        cmocka_unit_test(cut_documents_never_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

# Gazewall's build. `make help` lists the targets.
#
# Non-recursive: every object, test and generated file is named here once, found by wildcard, and lands under $(OUT).
# Library flags are asked from pkg-config once and kept in $(OUT)/libraries.mk; make remakes that file (and checks the
# installed packages before it) whenever .ci/packages or .ci/setup change, and costs nothing otherwise.

OUT     ?= out
FLAVOUR ?= release
PREFIX  ?= /usr/local
DESTDIR ?=
ONLY    ?=
V       ?=
WERROR  ?=

TREE := $(OUT)/$(FLAVOUR)

CC     ?= cc
AR     ?= ar
HOSTCC ?= cc

.DELETE_ON_ERROR:
.SUFFIXES:
.SECONDARY:
MAKEFLAGS += --no-builtin-rules

ifeq ($(V),1)
quiet =
say = @:
else
quiet = @
say = @printf '  %-8s %s\n'
endif

# --- what the goals need ---------------------------------------------------------------------------------------------

GOALS := $(or $(MAKECMDGOALS),all)
SETUP_GROUPS := run
SETUP_EXTRA := :
ifneq ($(filter test tests hard hard-full,$(GOALS)),)
SETUP_GROUPS += test
SETUP_EXTRA := .ci/setup --try extra >&2
endif
# demo, test and setup may install; a plain build only says what is missing.
SETUP_CHECK := --check
ifneq ($(filter demo test hard hard-full,$(GOALS)),)
SETUP_CHECK :=
endif
SETUP_STAMP := $(OUT)/setup-$(subst $() ,-,$(strip $(SETUP_GROUPS)))

# Goals that build nothing must work with nothing installed. The others see to the packages before any rule is read,
# once for each change of the list.
ifneq ($(filter-out clean help format setup,$(GOALS)),)
$(shell mkdir -p $(OUT); \
	[ $(SETUP_STAMP) -nt .ci/packages ] && [ $(SETUP_STAMP) -nt .ci/setup ] || \
	{ .ci/setup $(SETUP_CHECK) $(SETUP_GROUPS) >&2 && $(SETUP_EXTRA) && touch $(SETUP_STAMP); })
ifneq ($(.SHELLSTATUS),0)
$(error Packages are missing)
endif
include $(OUT)/libraries.mk
endif

# --- flags -----------------------------------------------------------------------------------------------------------

WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes
ifneq ($(WERROR),)
WARNINGS += -Werror
endif

FLAGS_release := -O2 -g
FLAGS_debug   := -Og -g3
FLAGS_asan    := -O1 -g -fsanitize=address,undefined -fno-omit-frame-pointer
FLAGS_tsan    := -O1 -g -fsanitize=thread -fno-omit-frame-pointer
FLAGS_fuzz    := -O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-omit-frame-pointer
ifndef FLAGS_$(FLAVOUR)
$(error FLAVOUR=$(FLAVOUR) is unknown: it is release, debug, asan or tsan)
endif
ifneq ($(filter asan fuzz,$(FLAVOUR)),)
LINK_FLAVOUR := -fsanitize=address,undefined
endif
ifeq ($(FLAVOUR),tsan)
LINK_FLAVOUR := -fsanitize=thread
endif

# Floats must not be contracted: the same expression has to give the same bits in every place and build.
BASE_FLAGS := -std=c11 -D_GNU_SOURCE -DGLFW_INCLUDE_NONE -I. -ffp-contract=off $(WARNINGS)
ALL_FLAGS   = $(BASE_FLAGS) $(FLAGS_$(FLAVOUR)) $(LIBRARY_CFLAGS) $(CPPFLAGS) $(CFLAGS)
DEP_FLAGS   = -MMD -MP -MF $(@:.o=.d)
LIBRARIES   = $(LIBRARY_LIBS) -lm -lrt -ldl -lpthread

# --- sources ---------------------------------------------------------------------------------------------------------

LIBRARY_FOLDERS := base tracking build render wall
SOURCES := $(filter-out wall/main.c,$(wildcard $(addsuffix /*.c,$(LIBRARY_FOLDERS))))
HEADERS := $(wildcard $(addsuffix /*.h,$(LIBRARY_FOLDERS))) $(wildcard tests/support/*.h)
EMBEDDED := $(sort $(wildcard shaders/*/*.comp shaders/*/*.vert shaders/*/*.geom shaders/*/*.frag shaders/*/*.glsl shaders/*/*.h configs/tracks/*.vrpn configs/tracks/*.gz configs/sites/*.yaml configs/profiles/*.yaml))

OBJECTS := $(SOURCES:%.c=$(TREE)/%.o) $(TREE)/generated/embedded_files.o
ARCHIVE := $(TREE)/libgazewall.a
PROGRAM := $(TREE)/gazewall
ifneq ($(wildcard wall/main.c),)
PROGRAMS := $(PROGRAM)
endif

TEST_KINDS   := unit gpu hard oracle
TEST_SOURCES := $(wildcard $(TEST_KINDS:%=tests/%/test_*.c))
# tests/tools/make_*, convert_* and compare_* are programs of their own; what else stands there are their parts, for tests too.
TOOL_SOURCES := $(wildcard $(addprefix tests/tools/,make_*.c convert_*.c compare_*.c))
TOOL_PARTS   := $(patsubst %.c,$(TREE)/%.o,$(filter-out $(TOOL_SOURCES),$(wildcard tests/tools/*.c)))
TOOLS        := $(TOOL_SOURCES:%.c=$(TREE)/%)
TEST_SUPPORT := $(patsubst %.c,$(TREE)/%.o,$(wildcard tests/support/*.c)) $(TOOL_PARTS)
SUPPORT      := $(TREE)/libsupport.a
TEST_PROGRAMS := $(TEST_SOURCES:%.c=$(TREE)/%)
FUZZ_SOURCES  := $(wildcard tests/fuzz/fuzz_$(or $(ONLY),*).c)
FUZZ_PROGRAMS := $(FUZZ_SOURCES:%.c=$(TREE)/%)

ALL_OBJECTS := $(OBJECTS) $(TREE)/wall/main.o $(TEST_SUPPORT) $(TEST_SOURCES:%.c=$(TREE)/%.o) \
	$(TREE)/shaders/assemble.o $(TREE)/docs/write_settings.o $(TOOLS:%=%.o) $(FUZZ_PROGRAMS:%=%.o)

# --- targets ---------------------------------------------------------------------------------------------------------

.PHONY: all setup demo tests test hard hard-full soak valgrind compare fuzz fuzz-programs tools lint format docs tracks demo-track moving-scene lit-scene record-ledger install clean help

all: $(PROGRAMS) $(ARCHIVE) $(if $(PROGRAMS),$(OUT)/gazewall)

help:
	@echo "make             build $(OUT)/gazewall"
	@echo "make demo        install what is missing, build, run the simulated wall into $(OUT)/demo"
	@echo "make test        install what is missing, build, run every test; ONLY=name picks some"
	@echo "make hard        the hard cases of tests/hard/catalogue.tsv, and what each test and its naive variant said"
	@echo "make hard-full   ten million rays at vertices and edges, 2,000 nasty scenes: an hour on software GL"
	@echo "make soak        200,000 frames through the gate at 35 tiles: nothing may grow (SOAK_FRAMES=n)"
	@echo "make fuzz        each decoder on made-up input for a minute (clang; FUZZ_SECONDS=n, ONLY=dtrack picks one)"
	@echo "make valgrind    the unit tests under valgrind's memcheck; ONLY=name picks some"
	@echo "make compare     scenes beside Blender's Cycles into $(OUT)/compare; ONLY='chess sedan' picks (.ci/setup compare, tests/scenes.sh first)"
	@echo "make tests       build the tests without running them"
	@echo "make tools       build the tools of tests/tools: scene converter, demo track"
	@echo "make lint        layout, static analysis, house rules, shaders; changes nothing"
	@echo "make format      lay the C sources out by .clang-format"
	@echo "make docs        write docs/settings.md from the table of settings, docs/hard-cases.md from the catalogue"
	@echo "make tracks      write the synthetic recordings of configs/tracks anew"
	@echo "make demo-track  write configs/tracks/demo.vrpn anew from its formula"
	@echo "make record-ledger  write tests/data/ledger.csv anew: the work and errors that tests hold frames to"
	@echo "make install     PREFIX=$(PREFIX) DESTDIR=$(DESTDIR)"
	@echo "make setup       only install what is missing (groups of .ci/packages: run test lint extra)"
	@echo "make clean       remove $(OUT)"
	@echo "variables        OUT=folder FLAVOUR=release|debug|asan|tsan V=1 (show commands) WERROR=1 CC CFLAGS"

setup:
	$(quiet).ci/setup run test lint
	$(quiet).ci/setup --try extra

demo: all
	$(quiet)mkdir -p $(OUT)/demo
	$(quiet)$(PROGRAM) sim --tiles 2x2 --bezel 12 --size 1280x720 --frames 8 --out $(OUT)/demo --report $(OUT)/demo/report.json

tests: $(ARCHIVE) $(TEST_PROGRAMS) $(TOOLS)

tools: $(TOOLS)

test: all tests
	$(quiet)tests/run.sh '$(TREE)' '$(ONLY)'

# Every test that the catalogue names, then what they said of each case and of its naive variant.
hard: all tests
	$(quiet)tests/run.sh '$(TREE)' "hard/ $$(tests/hard/catalogue.sh files | tr '\n' ' ')"; code=$$?; \
		tests/hard/catalogue.sh table '$(TREE)/test-logs'; exit $$code

# Ten million rays in each family, and more random scenes than a test has time for.
hard-full: all tests
	$(quiet)$(PROGRAM) bench precision --rays 10000000 --out $(OUT)/precision
	$(quiet)GW_NASTY_SCENES=2000 $(TREE)/tests/hard/test_nasty

SOAK_FRAMES ?= 200000
soak: all
	$(quiet)GAZEWALL='$(PROGRAM)' GW_SOAK_FRAMES='$(SOAK_FRAMES)' tests/mpi/gate_soak.sh

# No GL here: Mesa's own code reads what memcheck takes for uninitialised.
valgrind: all tests
	$(quiet)GW_TEST_SECONDS=1800 GW_TEST_UNDER='valgrind --quiet --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite' \
		tests/run.sh '$(TREE)' '$(or $(ONLY),unit/)'

compare: all tools
	$(quiet)PROGRAM='$(PROGRAM)' TOOL='$(TREE)/tests/tools/compare_pictures' tests/compare_cycles.sh $(ONLY)

# What is fuzzed is built apart, by clang: the fuzzer wants to see which branches are taken.
FUZZ_SECONDS ?= 60
fuzz:
	$(quiet)$(MAKE) --no-print-directory FLAVOUR=fuzz CC=clang ONLY='$(ONLY)' fuzz-programs
	$(quiet)tests/fuzz/run.sh '$(OUT)/fuzz/tests/fuzz' '$(FUZZ_SECONDS)' '$(ONLY)'

fuzz-programs: $(FUZZ_PROGRAMS)

lint: $(TREE)/assemble
	$(quiet)CC='$(CC)' FLAGS='$(BASE_FLAGS) $(LIBRARY_CFLAGS)' tests/lint.sh $(TREE)/assemble

format:
	$(quiet)clang-format -i $(wildcard $(addsuffix /*.[ch],$(LIBRARY_FOLDERS) tests/* shaders docs))

docs: $(TREE)/write_settings
	$(quiet)$< > $(TREE)/settings.md && mv $(TREE)/settings.md docs/settings.md
	$(quiet)tests/hard/catalogue.sh markdown > $(TREE)/hard-cases.md && mv $(TREE)/hard-cases.md docs/hard-cases.md

demo-track: $(TREE)/tests/tools/make_demo_track
	$(quiet)$< configs/tracks/demo.vrpn

# KIND:SEED:SECONDS of configs/tracks/KIND.vrpn.gz; a unit test compares what they expand to.
TRACKS := standing:1:10 walking:2:10 pursuit:3:10 saccades:4:10 two-viewers:5:6 dropouts:6:12
tracks: $(PROGRAM)
	$(quiet)for track in $(TRACKS); do \
		set -- $$(echo $$track | tr ':' ' '); \
		$(PROGRAM) record generate:$$1 configs/tracks/$$1.vrpn.gz --seed $$2 --seconds $$3 --overwrite || exit; \
	done

moving-scene: $(TREE)/tests/tools/make_moving_scene
	$(quiet)$< configs/scenes/moving.gltf

record-ledger: $(TREE)/tests/gpu/test_ledger
	$(quiet)GW_RECORD_LEDGER=1 $<

lit-scene: $(TREE)/tests/tools/make_lit_scene
	$(quiet)$< configs/scenes

install: all
	install -d '$(DESTDIR)$(PREFIX)/bin' '$(DESTDIR)$(PREFIX)/share/gazewall' '$(DESTDIR)$(PREFIX)/share/doc/gazewall/docs' \
		'$(DESTDIR)$(PREFIX)/share/man/man1'
	install -m 755 $(PROGRAM) '$(DESTDIR)$(PREFIX)/bin/gazewall'
	cp -R configs '$(DESTDIR)$(PREFIX)/share/gazewall/'
	sed 's|/usr/local/|$(PREFIX)/|' docs/gazewall.1 > '$(DESTDIR)$(PREFIX)/share/man/man1/gazewall.1'
	chmod 644 '$(DESTDIR)$(PREFIX)/share/man/man1/gazewall.1'
	install -m 644 README.md LICENSE '$(DESTDIR)$(PREFIX)/share/doc/gazewall/'
	install -m 644 $(wildcard docs/*.md docs/*.png docs/*.jpg docs/*.svg) '$(DESTDIR)$(PREFIX)/share/doc/gazewall/docs/'

clean:
	rm -rf $(OUT)

# --- libraries ----------------------------------------------------------------------------------------------------------

PACKAGES := epoxy egl glfw3 libpng libturbojpeg jansson yaml-0.1 cglm ompi-c zlib libxxhash assimp

# Headers of others are system headers: our warnings are for our code.
$(OUT)/libraries.mk: $(wildcard $(SETUP_STAMP)) Makefile
	@pkg-config --print-errors --exists $(PACKAGES)
	@{ printf 'LIBRARY_CFLAGS := %s\n' "$$(pkg-config --cflags $(PACKAGES) | sed 's/-I/-isystem /g')"; \
	   printf 'LIBRARY_LIBS := %s\n' "$$(pkg-config --libs $(PACKAGES))"; } > $@.part
	@if cmp -s $@.part $@; then rm $@.part; touch $@; else mv $@.part $@; fi

# --- rules -----------------------------------------------------------------------------------------------------------

# Rewritten only when the flags or the list of objects change; then what depends on it is remade. WERROR=1 makes the same
# objects.
define keep_text
$(shell mkdir -p $(dir $(1)); printf '%s' '$(2)' | cmp -s - $(1) || printf '%s' '$(2)' > $(1))
endef
ifneq ($(filter-out clean help format setup,$(GOALS)),)
$(call keep_text,$(TREE)/flags,$(CC) $(filter-out -Werror,$(ALL_FLAGS)))
$(call keep_text,$(TREE)/objects,$(sort $(OBJECTS)))
$(call keep_text,$(TREE)/support,$(sort $(TEST_SUPPORT)))
$(call keep_text,$(TREE)/embedded,$(EMBEDDED))
endif

$(TREE)/%.o: %.c $(TREE)/flags
	$(say) CC $<
	@mkdir -p $(@D)
	$(quiet)$(CC) $(ALL_FLAGS) $(DEP_FLAGS) -c -o $@ $<

$(TREE)/generated/%.o: $(TREE)/generated/%.c $(TREE)/flags
	$(quiet)$(CC) $(ALL_FLAGS) $(DEP_FLAGS) -c -o $@ $<

$(TREE)/embed_files: shaders/embed_files.c
	@mkdir -p $(@D)
	$(quiet)$(HOSTCC) -std=c11 -O1 -o $@ $<

$(TREE)/generated/embedded_files.c: $(TREE)/embed_files $(EMBEDDED) $(TREE)/embedded
	$(say) EMBED $@
	@mkdir -p $(@D)
	$(quiet)$(TREE)/embed_files $@ $(EMBEDDED)

$(ARCHIVE): $(OBJECTS) $(TREE)/objects
	$(say) AR $@
	$(quiet)rm -f $@ && $(AR) rcs $@ $(OBJECTS)

$(PROGRAM): $(TREE)/wall/main.o $(ARCHIVE)
	$(say) LINK $@
	$(quiet)$(CC) $(LINK_FLAVOUR) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

$(OUT)/gazewall: $(PROGRAM)
	$(quiet)ln -sf $(FLAVOUR)/gazewall $@

$(TREE)/assemble: $(TREE)/shaders/assemble.o $(ARCHIVE)
	$(quiet)$(CC) $(LINK_FLAVOUR) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

$(TREE)/write_settings: $(TREE)/docs/write_settings.o $(ARCHIVE)
	$(quiet)$(CC) $(LINK_FLAVOUR) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

$(TOOLS): $(TREE)/tests/tools/%: $(TREE)/tests/tools/%.o $(TOOL_PARTS) $(ARCHIVE)
	$(say) LINK $@
	$(quiet)$(CC) $(LINK_FLAVOUR) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

$(SUPPORT): $(TEST_SUPPORT) $(TREE)/support
	$(quiet)rm -f $@ && $(AR) rcs $@ $(TEST_SUPPORT)

$(TREE)/tests/fuzz/%: $(TREE)/tests/fuzz/%.o $(ARCHIVE)
	$(say) LINK $@
	$(quiet)$(CC) $(LINK_FLAVOUR) -fsanitize=fuzzer $(LDFLAGS) -o $@ $^ $(LIBRARIES)

# Every frame that a test draws, and every device it opens, goes by tests/support/clean_frames.c.
STRICT := -Wl,--wrap=gw_renderer_frame,--wrap=gw_gl_create
$(TREE)/tests/%: $(TREE)/tests/%.o $(SUPPORT) $(ARCHIVE)
	$(say) LINK $@
	$(quiet)$(CC) $(LINK_FLAVOUR) $(LDFLAGS) $(STRICT) -o $@ $< -Wl,--start-group $(filter %.a,$^) -Wl,--end-group $(LIBRARIES) -lcmocka $(if $(filter oracle/%,$*),-lembree3)

-include $(ALL_OBJECTS:.o=.d)

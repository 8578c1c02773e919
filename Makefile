# Farfield: one Makefile, no configure. `make help` lists the targets from the lines marked with two hashes.
#
# Flavours: `make SAN=1` builds everything with AddressSanitizer and UndefinedBehaviorSanitizer under build/san.
# Folders are layers; every folder is a static library, every *_main.c a program:
#   tools/bake/bake_main.c -> build/bin/farfield-bake

CC ?= cc
AR ?= ar
PREFIX ?= /usr/local
BUILD ?= $(if $(SAN),build/san,build)
PKG_CONFIG ?= pkg-config
VERSION := $(shell sed -n 's/^\#define FARFIELD_VERSION "\(.*\)"/\1/p' client/farfield.h)

WARN := -Wall -Wextra -Wpedantic -Wmissing-prototypes -Wstrict-prototypes -Wshadow -Wvla
OPT ?= $(if $(SAN),-O1 -g -fno-omit-frame-pointer -fsanitize=address$(,)undefined -fno-sanitize-recover=undefined,-O2 -g)
, := ,
CFLAGS_BASE = $(OPT) $(WARN) $(if $(WERROR),-Werror) -D_GNU_SOURCE -DFF_ENCODER=1 -MMD -MP
STD_core := -std=c99
STD_host := -std=c11
LDLIBS_core := -lz -ljpeg -lpthread
LDLIBS_surface := -lEGL -lOSMesa -lglfw -ldl
LDLIBS_host := -lpng16 -lm
GDAL_CFLAGS = $(shell $(PKG_CONFIG) --cflags gdal proj 2>/dev/null)
GDAL_LIBS = $(shell $(PKG_CONFIG) --libs gdal proj sqlite3 2>/dev/null)

# ---- sources, by layer: every folder of it, however deep. *_main.c are programs; *_none.c stand in for features left out (features.mk) ----
tree = $(sort $(wildcard $(1)/*.c $(1)/*/*.c $(1)/*/*/*.c))
srcs = $(filter-out %_main.c %_none.c,$(call tree,$(1)))
obj = $(patsubst %.c,$(BUILD)/obj/%.o,$(1))

SRC_core := $(foreach d,protocol client common3d,$(call srcs,$d))
SRC_surface := $(foreach d,platform/egl platform/osmesa platform/glfw,$(call srcs,$d))
SRC_null := $(call srcs,platform/null)
SRC_platform := $(filter-out $(SRC_surface) $(SRC_null),$(call srcs,platform))
SRC_server := $(call srcs,server)
SRC_tools := $(filter-out tools/scripts/%,$(call srcs,tools))
SRC_sim := $(call srcs,sim)
MAINS := $(filter %_main.c,$(foreach d,tools server sim,$(call tree,$d)))
program = $(patsubst %_main.c,$(BUILD)/bin/farfield-%,$(notdir $(1)))
PROGRAMS := $(sort $(call program,$(MAINS)))

LIB = $(BUILD)/lib
LIBS := $(LIB)/libffsim.a $(LIB)/libffserver.a $(LIB)/libfftools.a $(LIB)/libffcore.a $(LIB)/libffsurface.a \
        $(LIB)/libffplatform.a
LINK_LIBS = -Wl,--start-group $(LIBS) -Wl,--end-group $(LDLIBS_core) $(LDLIBS_surface) $(LDLIBS_host)

.DEFAULT_GOAL := all
.PHONY: all help null deps asserts format server emulator flyover front talk hashes demo test test-build check extremes numbers parts properties soak man install uninstall clean lib fuzz FORCE

all: $(PROGRAMS) lib null ## build all programs and libraries into build/

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1|\2/p' Makefile cross.mk | awk -F'|' '{printf "%-18s %s\n",$$1,$$2}'

# ---- what Debian 12 must have ----
DEPS := gcc make pkg-config zlib1g-dev libjpeg62-turbo-dev libpng-dev libosmesa6-dev libegl-dev libegl1 libgl1-mesa-dri \
        libglfw3-dev libgdal-dev libproj-dev gdal-bin libsqlite3-dev libcmocka-dev xvfb xauth python3 help2man gnuplot-nox man-db \
        clang-format python3-gdal
DEPS_STAMP := build/.deps

$(DEPS_STAMP): Makefile
	@tools/scripts/install-deps.sh $(DEPS)
	@mkdir -p $(@D) && touch $@

deps: $(DEPS_STAMP) ## install what is missing (Debian packages; says so first)

# ---- compiling ----
$(BUILD)/obj/tools/%.o $(BUILD)/obj/tests/tools/%.o: CFLAGS_LAYER = $(STD_host) $(GDAL_CFLAGS)
$(BUILD)/obj/server/%.o $(BUILD)/obj/sim/%.o $(BUILD)/obj/tests/%.o $(BUILD)/obj/platform/%.o: CFLAGS_LAYER = $(STD_host)
CFLAGS_LAYER = $(STD_core)
$(BUILD)/obj/platform/null/%.o: CFLAGS_LAYER = $(STD_core)
$(BUILD)/obj/%.o: %.c | $(DEPS_STAMP)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_BASE) $(CFLAGS_LAYER) $(CFLAGS) -fPIC -c $< -o $@

define archive
	@mkdir -p $(@D)
	@rm -f $@
	$(AR) rcsD $@ $(filter %.o,$^)
endef
$(LIB)/libffcore.a: $(call obj,$(SRC_core)); $(archive)
$(LIB)/libffplatform.a: $(call obj,$(SRC_platform)); $(archive)
$(LIB)/libffsurface.a: $(call obj,$(SRC_surface)); $(archive)
$(LIB)/libffserver.a: $(call obj,$(SRC_server)); $(archive)
$(LIB)/libfftools.a: $(call obj,$(SRC_tools)); $(archive)
$(LIB)/libffsim.a: $(call obj,$(SRC_sim)); $(archive)

# ---- programs ----
define program_rule
$(call program,$(1)): $(call obj,$(1)) $(LIBS)
	@mkdir -p $$(@D)
	$$(CC) $$(OPT) $$(LDFLAGS) $$< $$(LINK_LIBS) $(if $(filter tools/%,$(1)),$$(GDAL_LIBS)) -o $$@
endef
$(foreach m,$(MAINS),$(eval $(call program_rule,$m)))

server: $(BUILD)/bin/farfield-server ## the panorama server
emulator: $(BUILD)/bin/farfield-view ## the desktop emulator
flyover: $(PROGRAMS) ## fly all of Hybrid's Table 3 over emulated links; report in build/flyover (QUICK=1: a few short flights)
	@QUICK=$(QUICK) $(if $(DATA),FARFIELD_DATA=$(DATA)) tools/scripts/flyover.sh $(BUILD)/bin build/flyover

front: $(PROGRAMS) ## sweep settings over grounds, heights and links, about an hour: the front, and where named settings stand, in build/front (QUICK=1: a slice; FRONT="--grounds trinidad --links umts")
	@QUICK=$(QUICK) $(if $(DATA),FARFIELD_DATA=$(DATA)) tools/scripts/front.py $(BUILD)/bin build/front $(FRONT)

talk: $(BUILD)/bin/farfield-fly $(BUILD)/bin/farfield-link ## round trips after the start, a cut, a leap and a turn, and what requests and headers take, over PACKS="a.ffp b.ffp": build/talk/talk.md (TALK="--links gprs --seeds 1")
	@tools/scripts/talk.py $(TALK) $(BUILD)/bin $(BUILD)/talk $(PACKS)

hashes: $(PROGRAMS) ## hashes of packs, requests, geometry and pictures of ten flights: the same before and after a change that changes nothing
	@tools/scripts/hashes.sh $(BUILD)/bin build/hashes

demo: $(PROGRAMS) ## fetch real terrain, bake it, serve it, fly over it: pictures and a report in build/demo
	@tools/scripts/demo.sh $(BUILD)/bin build/demo

# ---- libfarfield: what an embedding program links ----
LIBFARFIELD_OBJS = $(call obj,$(SRC_core) $(filter-out platform/sim/% platform/options/%,$(SRC_platform)))
lib: $(LIB)/libfarfield.a $(LIB)/libfarfield.so
$(LIB)/libfarfield.a: $(LIBFARFIELD_OBJS); $(archive)
$(LIB)/libfarfield.so: $(LIBFARFIELD_OBJS)
	$(CC) $(OPT) -shared -Wl,-soname,libfarfield.so.0 $^ $(LDLIBS_core) -lpng16 -o $@

# ---- the blank port: all of the core over platform/null ----
NULL_OBJS = $(call obj,$(SRC_null) platform/random.c platform/events.c)
null: $(BUILD)/null-check ## check that the core builds over the blank port
	$<
$(BUILD)/null-check: $(NULL_OBJS) $(LIB)/libffcore.a
	$(CC) $(OPT) $(LDFLAGS) $(NULL_OBJS) -Wl,--whole-archive $(LIB)/libffcore.a -Wl,--no-whole-archive -lz -o $@

# ---- tests: test_*.c are cmocka programs, fuzz_*.c fuzz targets, *.sh scripts, in the rooms of tests/; tests/run.sh counts ----
SRC_tests := $(call tree,tests)
TEST_MAINS := $(foreach f,$(SRC_tests),$(if $(filter test_%,$(notdir $f)),$f))
FUZZ_MAINS := $(foreach f,$(SRC_tests),$(if $(filter fuzz_%,$(notdir $f)),$f))
# What `make test-cross` has instead of GL and libpng, and the loop round a fuzz target, go into no other test.
TEST_LIB_SRC := $(filter-out $(TEST_MAINS) $(FUZZ_MAINS) tests/rig/replay.c tests/rig/no_graphics.c,$(SRC_tests))
built_test = $(patsubst %.c,$(BUILD)/tests/%,$(notdir $(1)))
TESTS := $(call built_test,$(TEST_MAINS))
FUZZERS := $(addsuffix -replay,$(call built_test,$(FUZZ_MAINS)))
# $(call link_test,PROGRAM,SOURCES)
define link_test
$(1): $(call obj,$(2) $(TEST_LIB_SRC)) $(LIBS)
	@mkdir -p $$(@D)
	$$(CC) $$(OPT) $$(LDFLAGS) $$(filter %.o,$$^) $$(LINK_LIBS) $$(GDAL_LIBS) -lcmocka -o $$@
endef
$(foreach t,$(filter-out tests/protocol/test_turned.c,$(TEST_MAINS)),$(eval $(call link_test,$(call built_test,$t),$t)))
$(foreach t,$(FUZZ_MAINS),$(eval $(call link_test,$(call built_test,$t)-replay,$t tests/rig/replay.c)))
test-build: $(TESTS) $(FUZZERS)

# A second shape: what draws the ground is built once more, with the list of shapes of tests/protocol/turned_shapes.h.
TURNED_SRC := tests/protocol/test_turned.c tests/rig/terrain_fixture.c sim/judge/sim_watertight.c sim/judge/sim_rim.c \
              $(call srcs,protocol) $(call srcs,client/terrain)
TURNED_OBJS := $(TURNED_SRC:%.c=$(BUILD)/turned/%.o)
$(BUILD)/turned/%.o: %.c | $(DEPS_STAMP)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_BASE) $(STD_host) $(CFLAGS) -DFF_SHAPES_BUILT='"../../tests/protocol/turned_shapes.h"' -c $< -o $@
$(call built_test,tests/protocol/test_turned.c): $(TURNED_OBJS) $(LIBS)
	@mkdir -p $(@D)
	$(CC) $(OPT) $(LDFLAGS) $(TURNED_OBJS) $(LINK_LIBS) -lcmocka -o $@

test: deps ## build and run every test (sanitized, with script tests); the last line counts
	@MAKE="$(MAKE)" tests/run.sh

check: all $(TESTS) ## quick subset: layer checks and unit tests, without sanitizers
	@BUILD=$(BUILD) tests/run.sh --quick

asserts: ## functions and assertions of the core, by folder
	@tools/scripts/asserts.sh || true

format: deps ## lay out all C by .clang-format (tests/project/checks.sh holds the tree to it)
	@git ls-files '*.[ch]' | xargs clang-format -i

extremes: $(BUILD)/tests/test_extremes ## fly every stiff and extreme case and show the table of largest errors
	@EXTREMES=$(BUILD)/extremes.md $< >$(BUILD)/extremes.log 2>&1; rc=$$?; cat $(BUILD)/extremes.md; exit $$rc

# Undefined behaviour (overflow, shifts, division by zero, misaligned access) ends the run: no AddressSanitizer here, it has none of them.
UBSAN := -O1 -g -fsanitize=undefined -fno-sanitize-recover=undefined
NUMBERS := fixed reference join panorama_rules extremes
numbers: ## the integers against the double-precision reference and the extreme cases, an overflow anywhere ends it (VIEWS=1000000)
	@$(MAKE) -s BUILD=build/ubsan OPT="$(UBSAN)" $(NUMBERS:%=build/ubsan/tests/test_%)
	@for t in $(NUMBERS); do \
	    EXTREMES=build/ubsan/extremes.md $(if $(VIEWS),VIEWS=$(VIEWS)) build/ubsan/tests/test_$$t >build/ubsan/$$t.log 2>&1 || \
	        { tail -n 20 build/ubsan/$$t.log; echo "numbers: test_$$t failed" >&2; exit 1; }; \
	    grep '^# ' build/ubsan/$$t.log; \
	done; cat build/ubsan/extremes.md

# PACKS="a.ffp b.ffp": instead of three small ones; SEEDS=0: until interrupted; SOAK: more options of tests/sim/soak.py
SEEDS ?= 100
FIRST ?= 1
soak: $(BUILD)/bin/farfield-fly $(BUILD)/bin/farfield-bake $(BUILD)/bin/farfield-link ## random flights over random links (SEEDS=100 FIRST=1 PACKS=...); a failure tells the command that repeats it
	@tests/sim/soak.py --first $(FIRST) --seeds $(SEEDS) --bin $(BUILD)/bin --work $(BUILD)/soak $(SOAK) $(PACKS)

N ?= 1000
SEED ?= 1
parts: $(PROGRAMS) ## parts of packs cut and joined again, packs joined by chance: more of it than make test has (some minutes)
	@BIN=$(BUILD)/bin FULL=1 tests/tools/merge.sh && BIN=$(BUILD)/bin FULL=1 tests/tools/export_region.sh

properties: $(BUILD)/bin/farfield-bake $(BUILD)/bin/farfield-export $(BUILD)/tests/test_properties ## rasters by chance, baked, exported and fitted to their surface; the worst of each kind in build/properties/table.md (N=1000 SEED=1)
	@BIN=$(BUILD)/bin DRAWS=$(N) SEED=$(SEED) FIRST=$(FIRST) PROPERTIES=$(BUILD)/properties $(BUILD)/tests/test_properties; \
	    rc=$$?; cat $(BUILD)/properties/table.md; exit $$rc

# With clang there is libFuzzer: build/fuzz/fuzz_message -max_total_time=60 NEW-INPUTS-DIR tests/corpus/message. Saved inputs run in `make test`.
FUZZ_OPT := -O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined
fuzz: ## libFuzzer targets into build/fuzz (needs clang)
	@command -v clang >/dev/null || { echo "make fuzz: clang is not installed" >&2; exit 1; }
	@$(MAKE) CC=clang BUILD=build/fuzz OPT="$(FUZZ_OPT)" $(patsubst %.c,build/fuzz/%,$(notdir $(FUZZ_MAINS)))
define link_fuzzer
build/fuzz/$(basename $(notdir $(1))): $(call obj,$(1) $(TEST_LIB_SRC)) $(LIBS)
	clang $$(FUZZ_OPT) -fsanitize=fuzzer $$(LDFLAGS) $$(filter %.o,$$^) $$(LINK_LIBS) $$(GDAL_LIBS) -lcmocka -o $$@
endef
$(foreach t,$(FUZZ_MAINS),$(eval $(call link_fuzzer,$t)))

include features.mk cross.mk

# ---- installing: programs, libfarfield with its headers and farfield.pc, man pages ----
BINDIR ?= $(PREFIX)/bin
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
MANDIR ?= $(PREFIX)/share/man
HEADERS = $(shell $(CC) -MM -DFF_ENCODER=1 -x c client/farfield.h | tr -d '\\' | tr ' ' '\n' | grep '\.h$$' | \
            xargs realpath --relative-to=. | sort -u)
MANPAGES = $(patsubst $(BUILD)/bin/%,$(BUILD)/man/%.1,$(PROGRAMS))

man: $(MANPAGES) ## manual pages from --help, into build/man
$(BUILD)/man/%.1: $(BUILD)/bin/% tools/scripts/man.sh
	@mkdir -p $(@D)
	tools/scripts/man.sh $< $@

$(BUILD)/farfield.pc: tools/scripts/farfield.pc.in Makefile FORCE
	@mkdir -p $(@D)
	@sed -e 's|@PREFIX@|$(PREFIX)|; s|@LIBDIR@|$(LIBDIR)|; s|@INCLUDEDIR@|$(INCLUDEDIR)|; s|@VERSION@|$(VERSION)|' \
	     -e 's|@LIBS_PRIVATE@|$(LDLIBS_core) -lpng16|' $< > $@

install: all man $(BUILD)/farfield.pc ## install into PREFIX (default /usr/local); DESTDIR goes before it
	install -d $(addprefix $(DESTDIR),$(BINDIR) $(LIBDIR)/pkgconfig $(MANDIR)/man1)
	install -m 755 $(PROGRAMS) $(DESTDIR)$(BINDIR)
	install -m 644 $(LIB)/libfarfield.a $(DESTDIR)$(LIBDIR)
	install -m 755 $(LIB)/libfarfield.so $(DESTDIR)$(LIBDIR)/libfarfield.so.$(VERSION)
	ln -sf libfarfield.so.$(VERSION) $(DESTDIR)$(LIBDIR)/libfarfield.so.0
	ln -sf libfarfield.so.0 $(DESTDIR)$(LIBDIR)/libfarfield.so
	for h in $(HEADERS); do install -D -m 644 $$h $(DESTDIR)$(INCLUDEDIR)/farfield/$$h || exit 1; done
	install -m 644 $(BUILD)/farfield.pc $(DESTDIR)$(LIBDIR)/pkgconfig
	install -m 644 $(MANPAGES) $(DESTDIR)$(MANDIR)/man1

uninstall: ## remove what install put there (same PREFIX and DESTDIR)
	rm -f $(addprefix $(DESTDIR)$(BINDIR)/,$(notdir $(PROGRAMS))) $(addprefix $(DESTDIR)$(MANDIR)/man1/,$(notdir $(MANPAGES)))
	rm -f $(DESTDIR)$(LIBDIR)/libfarfield.* $(DESTDIR)$(LIBDIR)/pkgconfig/farfield.pc
	rm -rf $(DESTDIR)$(INCLUDEDIR)/farfield

clean: ## remove everything built
	rm -rf build

.SECONDARY:
-include $(shell find $(BUILD)/obj $(BUILD)/turned -name '*.d' 2>/dev/null)

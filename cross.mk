# Builds for other machines, included by the Makefile: the handheld (armv6, soft float), bare metal (Cortex-M, no system), the unit tests on
# 32-bit ARM and on a big-endian machine, instruction counts and sizes.
#
# Features left out: make handheld NO="panorama textures", any of those in features.mk.

# ---- packages: compilers and qemu are installed; libraries for other machines are unpacked under build/cross, see tools/scripts/cross-libs.sh ----
CROSS_DEPS := gcc-arm-linux-gnueabi libc6-dev-armel-cross gcc-s390x-linux-gnu libc6-dev-s390x-cross gcc-arm-none-eabi \
              libnewlib-arm-none-eabi qemu-user
CROSS_LIBS := zlib1g-dev libjpeg62-turbo-dev zlib1g libjpeg62-turbo libcmocka-dev libcmocka0 src:zlib
CROSS := build/cross
CROSS_STAMP := $(CROSS)/.fetched

$(CROSS_STAMP): tools/scripts/cross-libs.sh
	@tools/scripts/install-deps.sh $(CROSS_DEPS)
	@tools/scripts/cross-libs.sh $(CROSS) armel,s390x $(CROSS_LIBS)
	@touch $@

# ---- what runs on the handheld, and what a feature left out takes away ----
NO ?=
$(if $(filter-out $(FEATURES),$(NO)),$(error NO=$(NO): the features are $(FEATURES)))

DEVICE_CORE := $(filter-out protocol/codec/ff_encode% protocol/zlib/ff_deflate% common3d/gl%,$(SRC_core))
DEVICE_PLATFORM := $(filter-out platform/sim/% platform/posix/png.c platform/options/sys_option_real.c,$(SRC_platform))
DEVICE_PROGRAM := $(call srcs,sim/handheld) $(call srcs,sim/options) sim/tape/sim_tape.c sim/handheld/handheld_main.c

# ---- make handheld ----
ARM := arm-linux-gnueabi-
ARM_CPU := -march=armv6 -mtune=arm1136jf-s -mfloat-abi=soft -marm
ARM_FLAGS = -O2 -DNDEBUG $(WARN) $(if $(WERROR),-Werror) -D_GNU_SOURCE $(ARM_CPU) -ffunction-sections -fdata-sections -fcallgraph-info=su -MMD -MP \
            -isystem $(CROSS)/armel/usr/include -isystem $(CROSS)/armel/usr/include/arm-linux-gnueabi
ARM_LIBS := $(CROSS)/armel/usr/lib/arm-linux-gnueabi
HAND_OBJ := build/handheld/obj
space := $(subst ,, )
HAND = build/handheld/farfield-handheld$(if $(NO),-no-$(subst $(space),-,$(strip $(NO))))
HAND_SRC = $(call device,$(DEVICE_CORE) $(DEVICE_PLATFORM) $(DEVICE_PROGRAM),$(NO))
HAND_LIBS = $(if $(filter jpeg,$(NO)),,$(ARM_LIBS)/libjpeg.a) $(if $(filter deflate,$(NO)),,$(ARM_LIBS)/libz.a)

.PHONY: handheld
handheld: $(HAND) ## cross-build the client for an armv6 without FPU; fly it under qemu-arm (NO="..." leaves features out)
	@tools/scripts/handheld.sh $(HAND) $(BUILD)/bin $(HAND_OBJ) "$(strip $(FEATURES))" $(NO)
handheld: $(patsubst %,$(BUILD)/bin/farfield-%,bake server fly handheld)

$(HAND_OBJ)/platform/%.o $(HAND_OBJ)/sim/%.o: HAND_STD = $(STD_host)
HAND_STD = $(STD_core)
$(HAND_OBJ)/%.o: %.c | $(CROSS_STAMP)
	@mkdir -p $(@D)
	$(ARM)gcc $(ARM_FLAGS) $(HAND_STD) -c $< -o $@

# Linked anew when the list of files is another one. Without its warnings (static getaddrinfo) this linker is silent about missing symbols, too.
$(HAND): $(HAND_SRC:%.c=$(HAND_OBJ)/%.o)
	$(ARM)gcc $(ARM_CPU) -static -Wl,--gc-sections -Wl,--no-warnings -Wl,-Map=$@.map $^ $(HAND_LIBS) -lpthread -o $@
	@! $(ARM)nm $@ | grep ' U ' || { rm $@; echo "$@: missing symbols" >&2; exit 1; }

.PHONY: handheld-objects
handheld-objects: # what the program is linked from, for tools/scripts/handheld_rows.py
	@printf '%s\n' $(HAND_SRC:%.c=%.o)

-include $(shell find build/handheld -name '*.d' 2>/dev/null)

# ---- make bench-handheld: instructions by a plugin of qemu's translator. DATA=DIR (with puget-sound-gatech/, see flyover) flies over Puget
# Sound, PACK=... over any pack, FAR_PACK=... the flights with sets; BENCH_OPTIONS=--functions prints the functions that cost most, --far the
# tables of sets, --quick leaves out the sweep ----
BENCH := build/bench
BENCH_TILE := 7
PACK ?= $(BENCH)/$(if $(DATA),puget,ground).ffp
FAR_PACK ?= $(BENCH)/mountains.ffp
TCG_COUNT := build/handheld/libtcg_count.so
$(TCG_COUNT): tools/scripts/tcg_count.c
	@mkdir -p $(@D)
	$(CC) -std=c11 -O2 $(WARN) -fvisibility=hidden -fPIC -shared $< -o $@
$(BENCH)/ground.ffp: tools/scripts/bench_terrain.py $(BUILD)/bin/farfield-bake
	@mkdir -p $(@D)
	tools/scripts/bench_terrain.py $(@D)
	$(BUILD)/bin/farfield-bake $(@D)/ground.raw --raw 2049x2049 --scale 0.1 --spacing 50 --tile-log2 $(BENCH_TILE) --quiet \
	    --color $(@D)/ground.ppm --texture-levels 3 -o $@
$(BENCH)/mountains.ffp: $(BENCH)/ground.ffp
	$(BUILD)/bin/farfield-bake $(@D)/mountains.raw --raw 1025x1025 --scale 0.07 --spacing 90 --quiet -o $@
# As tools/scripts/flyover.sh has it: minutes, once for a version of packs (ff_pack.h).
PUGET := $(DATA)/puget-sound-gatech
$(BENCH)/puget.ffp: protocol/ff_pack.h | $(BUILD)/bin/farfield-bake
	@mkdir -p $(@D)
	$(BUILD)/bin/farfield-bake $(PUGET)/ps_height_1k.png --hscale 0.1 --spacing 160 --densify 16 --tile-log2 10 \
	    --color $(PUGET)/ps_texture_1k.png --texture-levels 5 -o $@

.PHONY: bench-handheld
bench-handheld: build/handheld/farfield-handheld $(TCG_COUNT) $(BUILD)/bin/farfield-fly $(BUILD)/bin/farfield-handheld $(BUILD)/bin/farfield-report $(PACK) $(FAR_PACK) ## ARM instructions a frame, by phase, and the work-precision curve: build/bench/handheld.md
	@tools/scripts/bench_handheld.py $(BUILD)/bin build/handheld/farfield-handheld $(TCG_COUNT) $(PACK) $(FAR_PACK) $(BENCH) $(BENCH_OPTIONS)
	@tools/scripts/look.sh $(BUILD)/bin $(PACK) $(BENCH)/look --start 0.3 --speed 900 --height 600
	@$(BUILD)/bin/farfield-report $(BENCH)/look/soft.csv $(BENCH)/look/gles1.csv -o $(BENCH)/look --title "Integers beside GL ES" \
	    --beside soft=$(BENCH)/look/soft --beside gles1=$(BENCH)/look/gles1
	@printf '\n## Look\n\n![The same flight by integers and by GL ES](look/side-by-side.png)\n' >>$(BENCH)/handheld.md

# ---- make bench-codec: what heights take, ours and others', and what decoding them takes (decode_pack.c, the core alone). DATA=DIR: real
# ground; BENCH_OPTIONS=--quick: a slice ----
CODEC_PEERS := libcharls2 liblerc4 libopenjp2-tools libjxl-tools
DECODE_PACK := build/handheld/decode_pack
$(DECODE_PACK): $(HAND_OBJ)/tools/scripts/decode_pack.o $(patsubst %.c,$(HAND_OBJ)/%.o,$(filter protocol/%,$(DEVICE_CORE)))
	$(ARM)gcc $(ARM_CPU) -static -Wl,--gc-sections $^ $(ARM_LIBS)/libz.a -o $@
DECODE_IMAGES := build/handheld/decode_images
$(DECODE_IMAGES): $(HAND_OBJ)/tools/scripts/decode_images.o $(patsubst %.c,$(HAND_OBJ)/%.o,$(filter protocol/%,$(DEVICE_CORE)) $(DEVICE_PLATFORM))
	$(ARM)gcc $(ARM_CPU) -static -Wl,--gc-sections $^ $(HAND_LIBS) -lpthread -o $@
# Others' libraries, as Debian builds them for armel; without them the bench goes on.
PEERS := build/peers
PEER_LIBS := libcharls2 libcharls-dev liblerc4 liblerc-dev libopenjp2-7 libopenjp2-7-dev libjxl0.7 libjxl-dev libbrotli1 libhwy1 liblcms2-2 libstdc++6 \
             libgcc-s1 libatomic1 libc6
DECODE_PEER := build/handheld/decode_peer
$(PEERS)/.fetched: tools/scripts/cross-libs.sh
	@tools/scripts/cross-libs.sh $(PEERS) armel $(PEER_LIBS)
	@touch $@
$(DECODE_PEER): tools/scripts/decode_peer.c tools/scripts/count_marks.h $(PEERS)/.fetched | $(CROSS_STAMP)
	$(ARM)gcc -O2 $(WARN) $(STD_host) -no-pie -isystem $(PEERS)/armel/usr/include -isystem $(PEERS)/armel/usr/include/openjpeg-2.5 $< \
	    -L$(PEERS)/armel/usr/lib/arm-linux-gnueabi -Wl,--allow-shlib-undefined -lcharls -lLerc -lopenjp2 -ljxl -o $@
# The baker and the exporter with the tables in the same folder, as farfield-train wrote them, in place of their own.
FOLD_LINK = $(CC) $(OPT) $(WARN) $(STD_host) -DFF_ENCODER=1 -Iprotocol/trained $(LDFLAGS) $(filter %tables.c %_main.o,$^) $(LINK_LIBS) $(GDAL_LIBS) -o $@
%/fold-bake: %/tables.c $(call obj,tools/bake/bake_main.c) $(LIBS)
	$(FOLD_LINK)
%/fold-export: %/tables.c $(call obj,tools/export/export_main.c) $(LIBS)
	$(FOLD_LINK)

.PHONY: bench-pictures
bench-pictures: $(patsubst %,$(BUILD)/bin/farfield-%,bake train) $(DECODE_IMAGES) $(TCG_COUNT) ## bytes of images of the ground beside JPEGs of the same error, and instructions a texel: build/bench/pictures.md (DATA=DIR)
	@$(if $(DATA),FARFIELD_DATA=$(DATA)) tools/scripts/bench_pictures.py $(BUILD)/bin $(BENCH) --decoder $(DECODE_IMAGES) --plugin $(TCG_COUNT)

.PHONY: bench-codec
bench-codec: $(patsubst %,$(BUILD)/bin/farfield-%,bake export info train) $(DECODE_PACK) $(TCG_COUNT) ## bits, errors and instructions of heights, ours beside JPEG-LS, LERC, JPEG 2000 and JPEG XL (some minutes): build/bench/codec.md (DATA=DIR: real ground)
	@tools/scripts/install-deps.sh $(CODEC_PEERS) || echo "bench-codec: goes on without what could not be installed" >&2
	@$(MAKE) -s $(DECODE_PEER) || echo "bench-codec: does not count what others take" >&2
	@MAKE="$(MAKE) -s" $(if $(DATA),FARFIELD_DATA=$(DATA)) tools/scripts/bench_codec.py $(BUILD)/bin $(BENCH) \
	    --decoder $(DECODE_PACK) --plugin $(TCG_COUNT) --peer-decoder $(DECODE_PEER) --peer-libs $(PEERS)/armel $(BENCH_OPTIONS)

# ---- make test-cross: the unit tests that need no graphics library, on 32-bit ARM and on a big-endian machine ----
CROSS_TESTS := key geo shape codec codec_trained trained_parts range far message pack fixed predict panorama_rules shade strips texture_map tree tree_pools tree_view watertight link \
               stream client budget soft c3d c3d_dynamic
CROSS_SRC := $(filter-out common3d/gl%,$(SRC_core)) $(filter-out platform/posix/png.c,$(SRC_platform)) server/session/ff_session.c \
             $(filter-out sim/link/sim_server.c sim/link/link_%,$(foreach d,sim/link sim/judge sim/tape,$(call srcs,$d))) \
             $(foreach t,client_fixture pack_fixture picture slow_decoder slow_tail slow_trained slow_far slow_watertight terrain_fixture trained_grid no_graphics,tests/rig/$t.c)
CROSS_MAINS := $(foreach t,$(CROSS_TESTS),$(filter %/test_$t.c,$(TEST_MAINS)))
CROSS_CASES := $(patsubst %,build/s390x/%.tap,$(CROSS_TESTS)) $(patsubst %,build/arm/%.tap,$(CROSS_TESTS))
# $(call cross_tests,NAME,COMPILER,DEBIAN ARCHITECTURE,TRIPLET,QEMU)
define cross_tests
build/$(1)/obj/%.o: %.c | $(CROSS_STAMP)
	@mkdir -p $$(@D)
	$(2) -O2 $(WARN) -D_GNU_SOURCE -DFF_ENCODER=1 -DTEST_STRIDE=5 -std=c11 -MMD -MP -isystem $(CROSS)/$(3)/usr/include \
	    -isystem $(CROSS)/$(3)/usr/include/$(4) -c $$< -o $$@
build/$(1)/libtested.a: $(CROSS_SRC:%.c=build/$(1)/obj/%.o) cross.mk
	@rm -f $$@
	$(AR) rcsD $$@ $$(filter %.o,$$^)
$(foreach t,$(CROSS_MAINS),$(eval build/$(1)/$(basename $(notdir $t)): build/$(1)/obj/$(t:.c=.o)))
build/$(1)/test_%: build/$(1)/libtested.a
	$(2) $$(filter %.o,$$^) $$< $(CROSS)/$(3)/usr/lib/$(4)/libjpeg.a $(CROSS)/$(3)/usr/lib/$(4)/libz.a $(CROSS)/$(3)/usr/lib/$(4)/libcmocka.so \
	    -lpthread -lm -o $$@
build/$(1)/%.tap: build/$(1)/test_%
	@CMOCKA_MESSAGE_OUTPUT=TAP $(5) -L /usr/$(4) -E LD_LIBRARY_PATH=$(CROSS)/$(3)/usr/lib/$(4) $$< >$$@ 2>&1 || { cat $$@; rm $$@; exit 1; }
	@echo "ok - $(1): test_$$* ($$$$(grep -c '^ok' $$@) cases)"
.PRECIOUS: build/$(1)/test_%
-include $(shell find build/$(1)/obj -name '*.d' 2>/dev/null)
endef
$(eval $(call cross_tests,arm,$(ARM)gcc $(ARM_CPU),armel,arm-linux-gnueabi,qemu-arm -cpu arm1136))
$(eval $(call cross_tests,s390x,s390x-linux-gnu-gcc,s390x,s390x-linux-gnu,qemu-s390x))

.PHONY: test-cross
test-cross: $(CROSS_CASES) ## unit tests on 32-bit ARM and on big-endian s390x, under qemu

# ---- make baremetal: the core over platform/null, for a Cortex-M without any operating system; zlib from Debian's source package ----
BARE := arm-none-eabi-
BARE_CPU := -mcpu=cortex-m3 -mthumb
BARE_FLAGS = -Os -DNDEBUG $(WARN) $(BARE_CPU) -std=c99 -ffunction-sections -fdata-sections -MMD -MP -isystem $(CROSS)/src/zlib
BARE_ZLIB := inflate inftrees inffast zutil adler32 crc32
BARE_SRC = $(sort $(call device,$(DEVICE_CORE) $(SRC_null) platform/random.c platform/events.c,$(filter-out hud,$(NO))))
BARE_ELF = build/baremetal/farfield$(if $(NO),-no-$(subst $(space),-,$(strip $(NO)))).elf
build/baremetal/%.o: %.c | $(CROSS_STAMP)
	@mkdir -p $(@D)
	$(BARE)gcc $(BARE_FLAGS) -c $< -o $@
build/baremetal/zlib/%.o: | $(CROSS_STAMP)
	@mkdir -p $(@D)
	$(BARE)gcc -Os $(BARE_CPU) -DNO_GZIP -ffunction-sections -c $(CROSS)/src/zlib/$*.c -o $@
$(BARE_ELF): $(BARE_SRC:%.c=build/baremetal/%.o) $(if $(filter deflate,$(NO)),,$(BARE_ZLIB:%=build/baremetal/zlib/%.o))
	$(BARE)gcc $(BARE_CPU) --specs=nano.specs --specs=nosys.specs -Wl,--no-warnings -Wl,-Map=$@.map $^ -o $@

.PHONY: baremetal
baremetal: $(BARE_ELF) ## link the core for a Cortex-M without a system, over the blank port; sizes (NO="..." as for handheld)
	@! $(BARE)nm -u $< | grep . || { echo "baremetal: missing symbols" >&2; exit 1; }
	@tools/scripts/check-no-float.sh $(BARE) $(filter build/baremetal/protocol/% build/baremetal/client/% build/baremetal/common3d/%,$(BARE_SRC:%.c=build/baremetal/%.o))
	@$(BARE)size $<
-include $(shell find build/baremetal -name '*.d' 2>/dev/null)

# ---- make size: code by part and by feature, worst stack, and what stays resident in a flight ----
.PHONY: size
size: build/handheld/farfield-handheld $(TCG_COUNT) build/handheld/size.tape ## code size by part and feature, stack, memory touched, pools: build/bench/size.md
	@for f in $(FEATURES) "$(strip $(FEATURES))"; do $(MAKE) -s NO="$$f" handheld-program || exit 1; done
	@tools/scripts/size_handheld.py build/handheld $(TCG_COUNT) $(PACK) build/bench $(FEATURES)
build/handheld/size.tape: build/handheld/farfield-handheld $(BUILD)/bin/farfield-fly $(PACK)
	$(BUILD)/bin/farfield-fly --pack $(PACK) --backend none --link umts --settle 15 --seconds 5 --tape $@ 2>/dev/null
.PHONY: handheld-program
handheld-program: $(HAND)

# What can be left out of the client: the one list, read by cross.mk, `make size` and tests/project/checks.sh (which holds README to it).
# A feature is a room: its folders and files go, its *_none.c stands in for what the rest of the client calls. Nothing else in the code asks
# whether a feature is there, but for constants like ff_panorama_built.
#   $(call feature,NAME,FOLDERS AND FILES THAT GO,FILES THAT STAND IN)
FEATURES :=
define feature_row
FEATURES += $(1)
WITHOUT_$(1) := $(foreach f,$(2),$(if $(filter %.c,$f),$f,$(call srcs,$f)))
INSTEAD_$(1) := $(3)
endef
feature = $(eval $(call feature_row,$(strip $(1)),$(2),$(strip $(3))))

$(call feature,panorama, client/panorama protocol/message/ff_face_columns.c, client/panorama/ff_panorama_none.c)
$(call feature,far, client/far client/terrain/ff_estimate_far.c protocol/far, client/far/ff_sets_none.c client/terrain/ff_estimate_far_none.c)
$(call feature,textures, client/images, client/images/ff_textures_none.c)
$(call feature,network, client/source/link protocol/message/ff_message.c platform/posix/tcp.c, \
    client/source/link/ff_stream_none.c platform/null/null_tcp.c)
$(call feature,jpeg, platform/posix/jpeg.c platform/posix/jpeg_tables.c, platform/null/null_jpeg.c)
$(call feature,hud, sim/handheld/handheld_hud.c common3d/c3d_text.c, sim/handheld/handheld_hud_none.c)
$(call feature,deflate, protocol/zlib, protocol/zlib/ff_inflate_none.c protocol/zlib/ff_crc_none.c)
$(call feature,trained, protocol/trained, protocol/trained/ff_trained_none.c)
$(call feature,picture, protocol/picture client/images/ff_pack_images.c, protocol/picture/ff_picture_none.c)
$(call feature,labels, common3d/soft/soft_label.c, common3d/soft/soft_label_none.c)
$(call feature,grounds, client/terrain/ff_grounds.c client/terrain/ff_cover.c client/terrain/ff_seam.c client/terrain/ff_seam_dive.c client/terrain/ff_seam_rim.c client/several, \
    client/terrain/ff_grounds_none.c client/several/ff_several_none.c)
$(call feature,map, client/map sim/handheld/handheld_map.c, client/map/ff_contours_none.c sim/handheld/handheld_map_none.c)
$(call feature,geo, protocol/geo, protocol/geo/ff_geo_none.c)
$(call feature,balance, client/balance, client/balance/ff_balance_none.c)

# $(call device,SOURCES,FEATURES LEFT OUT)
device = $(filter-out $(foreach f,$(2),$(WITHOUT_$f)),$(1)) $(foreach f,$(2),$(INSTEAD_$f))

.PHONY: features
features: # the names alone, for scripts
	@echo $(strip $(FEATURES))

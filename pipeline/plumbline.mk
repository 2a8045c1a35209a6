# SPDX-License-Identifier: Apache-2.0
#
# The one place where Plumbline's graph is written. A site's Makefile includes it:
#
#     include $(shell plumbline --graph)
#
# Targets: `all` (the certificate and everything under it), a stage's name (that stage for all blocks), a block's name
# (its map), or any file named below. Variables: LAUNCH is put before every stage command (examples/cluster/srun-verified);
# PLUMBLINE_THREADS limits the threads of each stage (0: all cores) and never changes a result.
#
# When does a stage run again? Its stamp, work/.stamps/[BLOCK-]STAGE, holds the command that last succeeded and bears the
# time at which it began; beside it, STAMP.toml keeps the slice that it ran with (see below), for `plumbline status`.
# The stage runs when
#   - an input is newer than the stamp. Outputs that come out identical keep their time stamps, so an unchanged result
#     stops the chain there. For files that people supply, work/.sources/FILE stands in: `plumbline configure` rewrites
#     it whenever size or time of FILE changes in any direction (an older version put back counts as a change);
#   - its configuration slice, work/[BLOCK/]config/STAGE.toml, is newer: a key that the stage knows, or the program
#     itself, has changed. `plumbline configure` writes the slices, also by the rule of unchanged content;
#   - the command is another one: an optional file, a mark list, an edit or a block came or went;
#   - an output is missing.
# A stage that failed or was killed leaves its stamp as it was and therefore runs again.

MAKEFLAGS += --no-builtin-rules --no-builtin-variables
.SUFFIXES:
.DEFAULT_GOAL := all
.PHONY: all graph FORCE
FORCE:
LAUNCH ?=
PLUMBLINE_THREADS ?= 0

plumbline.bin := $(abspath $(dir $(lastword $(MAKEFILE_LIST)))../../bin)
export PATH := $(plumbline.bin):$(PATH)

plumbline.block-stages := feedback ingest track loops adjust grid edit features
plumbline.site-stages := network join requests stitch robots certify report print

# Checks the site, brings slices and sources up to date and keeps a second `make` out until this one ends. `graph` only
# looks and needs no lock.
plumbline.goals-that-look := graph
plumbline.lock := $(if $(filter $(plumbline.goals-that-look),$(MAKECMDGOALS)),,--make-pid $$PPID)
plumbline.output := $(shell $(plumbline.bin)/plumbline configure $(plumbline.lock) \
  --block-stages '$(plumbline.block-stages)' --site-stages '$(plumbline.site-stages)')
ifneq ($(.SHELLSTATUS),0)
$(error The site is not ready: see the message above)
endif

# $(call source,FILES): what a rule names instead of files that people supply.
source = $(addprefix work/.sources/,$(1))

# $(call stage,STAGE,BLOCK or empty,INPUTS,OUTPUTS,ARGUMENTS): the rules of one run of one stage.
plumbline.runs :=
define stage
$(eval run := $(if $(2),$(2)-)$(1))
$(eval slice := work/$(if $(2),$(2)/)config/$(1).toml)
$(eval plumbline.runs += $(run))
$(eval $(run).stage := $(1))
$(eval $(run).block := $(2))
$(eval $(run).slice := $(slice))
$(eval $(run).inputs := $(slice) $(3))
$(eval $(run).outputs := $(4))
$(eval $(run).command := plumbline-$(1) $(strip $(5)) --config $(slice))
$(eval $(call stage-rules,$(1),$(2),$(run)))
endef

define stage-rules
work/.stamps/$(3): $($(3).inputs) $(call changed-command,$(3)) $(call missing-output,$(3))
	$$(info $(strip $(2) $(1)))$$(file >work/.stamps/begun/$(3),$($(3).command))
	$$(file >work/.stamps/begun/$(3).toml,$$(file <$($(3).slice)))
	@$$(LAUNCH) $($(3).command) --log logs/$(3).log --threads $$(PLUMBLINE_THREADS)
	@mv -f work/.stamps/begun/$(3).toml work/.stamps/begun/$(3) work/.stamps
$($(3).outputs): work/.stamps/$(3) ; @:
$(1): $($(3).outputs)
endef

# `strip`: GNU make 4.3 now and then leaves the newline at the end of a file that it reads.
changed-command = $(if $(call same,$($(1).command),$(strip $(file <work/.stamps/$(1)))),,FORCE)
same = $(and $(findstring |$(1)|,|$(2)|),$(findstring |$(2)|,|$(1)|))
missing-output = $(if $(filter-out $(wildcard $($(1).outputs)),$($(1).outputs)),FORCE)

# ---------------------------------------------------------------------------------------------------------- the graph

blocks := $(sort $(patsubst blocks/%/,%,$(wildcard blocks/*/)))
# Control is one file of any kind that `network` reads; beside it there may be roles, a tie of a site grid, features.
beside-control := control/features.csv control/roles.csv control/grid-tie.csv
points := $(sort $(filter-out $(beside-control),$(wildcard $(addprefix control/*.,csv txt gkf dat xml))))
roles := $(wildcard control/roles.csv)
grid-tie := $(wildcard control/grid-tie.csv)
features := $(wildcard control/features.csv)
# What `plumbline deliver` noted, both files or none.
delivered := $(if $(and $(wildcard delivered/control.csv),$(wildcard delivered/poses.csv)),delivered/control.csv delivered/poses.csv)
accuracy-classes := $(wildcard accuracy-classes.toml)
# Of the edits only masks (to the field data) and arrows (to the adjustment) reach back.
ledger := $(wildcard edits/ledger.jsonl)
$(if $(ledger),,$(if $(wildcard edits/*.geojson),$(warning edits/*.geojson do not count by themselves: \
  `plumbline edits add` takes them into the ledger)))
reaching-back = $(if $(ledger),$(shell grep -l '"kind":"$(1)"' $(ledger)))
masked := $(call reaching-back,mask_returns)
with-arrows := $(call reaching-back,adjust)
masks-of = $(if $(masked),work/$(1)/masks.json)
arrows-of = $(if $(with-arrows),work/$(1)/arrows.json)
raw = $(sort $(wildcard blocks/$(1)/raw/*))
marks = $(wildcard blocks/$(1)/marks.csv)
answers = $(sort $(wildcard blocks/$(1)/answers/*.json))
marked-blocks := $(strip $(foreach b,$(blocks),$(if $(call marks,$(b)),$(b))))
# A block is tied when there is control and a list of its marks.
control-of = $(if $(points),$(if $(call marks,$(1)),work/$(1)/control.sqlite))

# Blocks that control ties. With `joint = true` in site.toml they are adjusted together after each by itself.
tied-blocks := $(strip $(foreach b,$(blocks),$(if $(call control-of,$(b)),$(b))))
joint-blocks := $(if $(findstring joint = true,$(file <work/config/join.toml)),$(tied-blocks))
adjusted-of = $(if $(filter $(1),$(joint-blocks)),work/$(1)/adjusted.sqlite,work/$(1)/solution.sqlite)
graph-of = $(if $(filter $(1),$(joint-blocks)),work/$(1)/graph.sqlite)
joint-control := $(if $(joint-blocks),work/joint-control.sqlite)

# $(call named,BLOCKS,FILE): B1=work/B1/FILE ...
named = $(foreach b,$(1),$(b)=work/$(b)/$(2))
of-blocks = $(foreach b,$(1),work/$(b)/$(2))

define block
$(if $(masked)$(with-arrows),$(call stage,feedback,$(1),$(call source,$(ledger)),work/$(1)/masks.json work/$(1)/arrows.json,\
  --ledger $(ledger) --block $(1) --masks work/$(1)/masks.json --arrows work/$(1)/arrows.json))
$(call stage,ingest,$(1),$(call source,$(call raw,$(1)) $(call marks,$(1))) $(call masks-of,$(1)),\
  work/$(1)/session.sqlite,\
  --raw $(call raw,$(1)) $(addprefix --marks ,$(call marks,$(1))) $(addprefix --masks ,$(call masks-of,$(1)))\
  --output work/$(1)/session.sqlite)
$(call stage,track,$(1),work/$(1)/session.sqlite $(call source,$(call answers,$(1))),work/$(1)/track.sqlite,\
  --session work/$(1)/session.sqlite $(addprefix --answers ,$(call answers,$(1))) --output work/$(1)/track.sqlite\
  --cache work/$(1)/particles.cache)
$(call stage,loops,$(1),work/$(1)/session.sqlite work/$(1)/track.sqlite,work/$(1)/loops.sqlite,\
  --session work/$(1)/session.sqlite --track work/$(1)/track.sqlite --output work/$(1)/loops.sqlite)
$(call stage,adjust,$(1),work/$(1)/track.sqlite work/$(1)/loops.sqlite $(call control-of,$(1))\
  $(call source,$(call answers,$(1))) $(call arrows-of,$(1)),$(call adjusted-of,$(1)) $(call graph-of,$(1)),\
  --track work/$(1)/track.sqlite --loops work/$(1)/loops.sqlite $(addprefix --control ,$(call control-of,$(1)))\
  $(addprefix --answers ,$(call answers,$(1))) $(addprefix --arrows ,$(call arrows-of,$(1)))\
  --output $(call adjusted-of,$(1)) $(addprefix --graph ,$(call graph-of,$(1))))
$(call stage,grid,$(1),work/$(1)/session.sqlite work/$(1)/solution.sqlite,work/$(1)/grid.tif,\
  --session work/$(1)/session.sqlite --solution work/$(1)/solution.sqlite --output work/$(1)/grid.tif)
$(call stage,edit,$(1),work/$(1)/grid.tif work/$(1)/solution.sqlite $(call source,$(ledger)),\
  work/$(1)/map.tif work/$(1)/edits.json work/$(1)/doubtful_edits.json,\
  --grid work/$(1)/grid.tif --solution work/$(1)/solution.sqlite $(addprefix --ledger ,$(ledger)) --block $(1)\
  --output work/$(1)/map.tif --report work/$(1)/edits.json --doubtful work/$(1)/doubtful_edits.json)
$(if $(features),$(call stage,features,$(1),$(foreach f,grid.tif session.sqlite solution.sqlite,work/$(1)/$(f)) $(call source,$(features)),work/$(1)/features.sqlite,\
  --map work/$(1)/grid.tif --session work/$(1)/session.sqlite --solution work/$(1)/solution.sqlite --features $(features) --output work/$(1)/features.sqlite))
$(eval .PHONY: $(1))
$(eval $(1): work/$(1)/map.tif ; @:)
endef
$(foreach b,$(blocks),$(call block,$(b)))

$(call stage,network,,$(call source,$(points) $(roles) $(grid-tie) $(foreach b,$(marked-blocks),$(call marks,$(b)))),\
  work/control.sqlite $(call of-blocks,$(marked-blocks),control.sqlite) $(joint-control),\
  $(if $(points),--control $(points)) $(addprefix --roles ,$(roles)) $(addprefix --grid-tie ,$(grid-tie)) $(if $(marked-blocks),--marks $(foreach b,$(marked-blocks),$(b)=$(call marks,$(b))))\
  --output work/control.sqlite --extracts work $(addprefix --joint-extract ,$(joint-control)))

$(if $(joint-blocks),$(call stage,join,,$(joint-control) $(foreach f,session track graph adjusted,\
  $(call of-blocks,$(joint-blocks),$(f).sqlite)),work/joint.json $(call of-blocks,$(joint-blocks),solution.sqlite),\
  --control $(joint-control) --session $(call named,$(joint-blocks),session.sqlite)\
  --track $(call named,$(joint-blocks),track.sqlite) --graph $(call named,$(joint-blocks),graph.sqlite)\
  --solution $(call named,$(joint-blocks),adjusted.sqlite) --output work --report work/joint.json))
joint-report := $(if $(joint-blocks),work/joint.json)

# Blocks that are not tied have no place on the site's map and are delivered apart, unless there is but one block.
site-blocks := $(if $(filter 1,$(words $(blocks))),$(blocks),$(tied-blocks))
local-blocks := $(filter-out $(site-blocks),$(blocks))
site-map := $(if $(site-blocks),out/site.tif)
float-archive := $(if $(findstring float-archive = true,$(file <work/config/stitch.toml)),$(if $(site-map),out/site-log-odds.tif))
picture-of = $(1).png $(1).pgw $(1).png.aux.xml

$(call stage,stitch,,$(call of-blocks,$(blocks),map.tif) $(call of-blocks,$(blocks),solution.sqlite),\
  $(float-archive) $(if $(site-map),$(site-map) $(call picture-of,out/site) $(addprefix out/ros/,map.yaml map_local.yaml map.pgm))\
  $(foreach b,$(local-blocks),out/local/$(b).tif $(call picture-of,out/local/$(b))) out/seams.json out/seams.geojson,\
  --map $(call named,$(blocks),map.tif) --solution $(call named,$(blocks),solution.sqlite) --output out)

# Of all blocks; the pictures go into work/requests/. Of the edits only those in doubt count: others change nothing here.
of-each = $(foreach f,session.sqlite track.sqlite loops.sqlite solution.sqlite grid.tif doubtful_edits.json,$(call of-blocks,$(blocks),$(f)))
$(call stage,requests,,$(of-each) $(call source,$(foreach b,$(blocks),$(call answers,$(b)))),work/requests.jsonl,\
  --session $(call named,$(blocks),session.sqlite) --track $(call named,$(blocks),track.sqlite)\
  --loops $(call named,$(blocks),loops.sqlite) --solution $(call named,$(blocks),solution.sqlite)\
  --grid $(call named,$(blocks),grid.tif) --edits $(call named,$(blocks),doubtful_edits.json)\
  $(foreach b,$(blocks),$(addprefix --answers $(b)=,$(call answers,$(b)))) --output work/requests.jsonl)

# Edits of the blocks, once there are any.
edits-of = $(if $(ledger),$(1))
$(if $(ledger),$(if $(site-map),$(call stage,robots,,$(site-map) $(call of-blocks,$(site-blocks),edits.json),\
  $(addprefix out/ros/,keepout.pgm keepout.yaml keepout_local.yaml vector_objects.yaml),\
  --site-map $(site-map) --edits $(call named,$(site-blocks),edits.json) --output out/ros)))

$(call stage,certify,,work/control.sqlite $(call of-blocks,$(blocks),solution.sqlite)\
  $(call edits-of,$(call of-blocks,$(blocks),edits.json))\
  $(if $(features),$(call of-blocks,$(blocks),features.sqlite) $(call source,$(features))) out/seams.json work/requests.jsonl\
  $(joint-report)\
  $(call source,$(accuracy-classes)) $(call source,$(delivered)),\
  out/certificate.json,\
  --control work/control.sqlite --solution $(call named,$(blocks),solution.sqlite)\
  $(if $(features),--features $(call named,$(blocks),features.sqlite) --feature-list $(features))\
  $(addprefix --classes ,$(accuracy-classes)) $(call edits-of,--edits $(call named,$(blocks),edits.json)) --seams out/seams.json --requests work/requests.jsonl\
  $(addprefix --joint ,$(joint-report))\
  $(if $(delivered),--delivered-control delivered/control.csv --delivered-poses delivered/poses.csv)\
  --output out/certificate.json)

$(call stage,report,,out/certificate.json $(site-map) $(call of-blocks,$(blocks),solution.sqlite)\
  $(call edits-of,$(call of-blocks,$(site-blocks),edits.json)) $(call source,$(ledger)),\
  out/certificate.html out/site.gpkg out/site.qgs out/site.dxf,\
  --certificate out/certificate.json $(addprefix --site-map ,$(site-map))\
  --solution $(call named,$(blocks),solution.sqlite) --geopackage out/site.gpkg --project out/site.qgs --dxf out/site.dxf\
  $(call edits-of,--edits $(call named,$(site-blocks),edits.json)) $(addprefix --ledger ,$(ledger))\
  --output out/certificate.html)

# On paper where WeasyPrint is installed; WEASYPRINT= leaves the PDF out.
WEASYPRINT ?= $(shell command -v weasyprint)
$(if $(WEASYPRINT),$(call stage,print,,out/certificate.html,out/certificate.pdf,\
  --page out/certificate.html --output out/certificate.pdf))
print: ; @$(if $(WEASYPRINT),:,echo 'no PDF: WeasyPrint is not installed (Debian package weasyprint)' >&2)

.PHONY: $(plumbline.block-stages) $(plumbline.site-stages)
$(filter-out print,$(plumbline.block-stages) $(plumbline.site-stages)): ; @:

all: $(foreach r,$(plumbline.runs),$($(r).outputs)) ; @:

# For `plumbline status`: one line per run. Fields: run|stage|block|inputs|outputs|command.
graph: ; @:
ifneq ($(filter graph,$(MAKECMDGOALS)),)
$(foreach r,$(plumbline.runs),$(info $(r)|$($(r).stage)|$($(r).block)|$($(r).inputs)|$($(r).outputs)|$($(r).command)))
endif

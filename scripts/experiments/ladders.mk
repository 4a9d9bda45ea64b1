# make -f ladders.mk     the appearance ladders of three objects: run/table.txt
# A translucent bunny, an object of glass and one of metal are photographed in a
# simulation (render --record), placed by align, and rendered rung by rung, each
# with a little more physics. Every rung is compared with the photographs, and
# explain is asked there which physics is missing: it should name what the next
# rung adds, and nothing at the top (run/*-explained.html).
# The prints and the bust of the thesis are in no data set: the bunny is that of
# the recordings, and glass and metal have the shape of fandisk.obj. The bunny
# has one view, as there, but three lamps.
# Glass, mirrors and laws are asked by the path tracer (domain traced), matte and
# coated things by the fast model (images), metals and bodies of which that knows
# a part by both, one after the other: what either names counts.
# SEED draws places, lamps, cameras, the material's numbers and the noise. The
# rungs were written on seed 1; others are for reports. BUDGET bounds the work
# of each explain; without it the answers take two to four times as long.
CASES  = bunny glass metal
SEED   = 1
SPP    = 64
BUDGET = 10s
PHOTO_SPP_bunny = 256
PHOTO_SPP_glass = 2048
PHOTO_SPP_metal = 256
RUNGS_bunny = 0 1 2 3 4
RUNGS_glass = 0 1 2 3
RUNGS_metal = 0 1 2
GONIO_DATA ?= $(dir $(lastword $(MAKEFILE_LIST)))../../../shared/data

LADDERS = python3 $(dir $(lastword $(MAKEFILE_LIST)))ladders.py
RUNGS   = $(foreach c,$(CASES),$(RUNGS_$c:%=$c-%))
CASE    = $(word 1,$(subst -, ,$1))
RUNG    = $(word 2,$(subst -, ,$1))
MASKS_bunny = --masks lamps
MASKS_metal = --masks lamps
MASKS_glass = --masks background $(foreach v,0 1,--background \
              view-$v-lamp-0=view-$v-lamp-0-empty)
# A rung's surface may follow from the fit of the rung below.
LOWER_bunny-3 = run/bunny-2-fitted.json
LOWER_bunny-4 = run/bunny-3-fitted.json

.RECIPEPREFIX = >
.SECONDEXPANSION:
.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all clean
all: run/table.txt

run/%.ply: | run
> $(LADDERS) mesh $* $(GONIO_DATA) $@

run/%-truth.json: run/%.ply
> $(LADDERS) truth $* $(SEED) > $@

run/%-photographs.json: run/%-truth.json
> render $< --record --spp $(PHOTO_SPP_$*) --seed $(SEED)01 --force --preview \
>   --out run/$*-photographs -o $@

# Where: by masks from the photographs themselves; where these do not do, as of
# clear and of mirroring things, by photographs of the object sprayed matte.
run/%-sprayed.json: run/%-truth.json
> $(LADDERS) sprayed $< > run/$*-matte.json
> render run/$*-matte.json --record --spp $(SPP) --seed $(SEED)02 --force \
>   --preview --out run/$*-sprayed -o $@
run/%-empty.json: run/%-truth.json
> $(LADDERS) empty $< > run/$*-paper.json
> render run/$*-paper.json --record --spp $(SPP) --seed $(SEED)03 --force \
>   --out run/$*-empty -o $@
run/%-start.json: run/%.json $$(if \
  $$(findstring glass,$$*),run/glass-empty.json)
> $(LADDERS) disturbed $< $(SEED) $(filter %-empty.json,$^) > $@
run/%-aligned.json: run/%-photographs-start.json run/%-sprayed-start.json
> align -i $< $(MASKS_$*) --force --html run/$*-direct.html --out \
>   run/$*-direct -o $@ 2> run/$*-align.txt || { test $$? -le 2 && align -i \
>   run/$*-sprayed-start.json $(MASKS_$*) --force --html run/$*-align.html \
>   --out run/$*-align -o $@ 2>> run/$*-align.txt; }
> cat run/$*-align.txt

# The rungs. The fit: one hypothesis, and an effect that nothing reaches, leave
# the free numbers of the rung alone to explain. Up to 2 it has answered.
$(RUNGS:%=run/%-rung.json): run/%-rung.json: \
  $$(addprefix run/$$(call CASE,$$*),-aligned.json -photographs.json) \
  $$(LOWER_$$*)
> $(LADDERS) rung $(call CASE,$*) $(call RUNG,$*) $^ > $@

run/%-fitted.json: run/%-rung.json
> explain $< --hypotheses optics.ghost --negative-controls 0 \
>   --smallest-effect 100% --budget $(BUDGET) --force -o $@ 2> \
>   run/$*-fitted.txt || test $$? -le 2 || cp $< $@

run/%-rendered.json: run/%-fitted.json
> render $< --spp $(SPP) --seed $(SEED)04 --force --preview --aov off \
>   --out run/$* -o $@

run/%-compared.json: run/%-rendered.json
> compare $< --html run/$*-compared.html --force -o $@

# Above 2 explain has no answer, which the table says.
run/%-explained.txt: run/%-fitted.json
> explain $< --budget $(BUDGET) --html run/$*-explained.html --force \
>   -o run/$*-explained.json 2> $@ || test $$? -le 2 || rm -f \
>   run/$*-explained.json
> @cat $@

run/table.txt: $(RUNGS:%=run/%-compared.json) $(RUNGS:%=run/%-explained.txt)
> $(LADDERS) table $(CASES) > $@
> @cat $@

run:
> mkdir -p run

clean:
> rm -rf run

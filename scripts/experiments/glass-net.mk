# make -j2 -f glass-net.mk       table 2: which input says most of glass
# Networks on RGB, Stokes vectors and intensities behind polarizers, with the
# screen's light alone and with the room's, with and without normals of the
# back, SEEDS times each, on the set that glass.mk made. GLASS_NET is the folder
# scripts/glass-net of the sources; it needs Debian's python3-torch.
# make -f glass-net.mk weights   one network for glass-net(1), with a scale for
#                                each pixel, and how honest its scales are
SET     = run/set
GLASS_NET = $(dir $(lastword $(MAKEFILE_LIST)))../glass-net
SEEDS   = 1 2 3
INPUTS  = rgb stokes intensities
LIGHTS  = bare lit
BACKS   = back front
EPOCHS  = 40
WIDTH   = 16
MORE    =
WEIGHTS_INPUT = stokes
WEIGHTS_LIGHT = bare

RUNS = $(foreach i,$(INPUTS),$(foreach l,$(LIGHTS),$(foreach b,$(BACKS),\
       $(foreach s,$(SEEDS),$i-$l-$b-$s))))
part = $(word $1,$(subst -, ,$2))

.RECIPEPREFIX = >
.SECONDARY:
.PHONY: all weights clean
all: run/nets/table.txt
weights: run/weights/reliability.txt

$(RUNS:%=run/nets/%/run.json): run/nets/%/run.json: run/set.json
> $(GLASS_NET)/train --set $(SET) --input $(call part,1,$*) \
>   --light $(call part,2,$*) --seed $(call part,4,$*) --epochs $(EPOCHS) \
>   $(if $(filter front,$(call part,3,$*)),--without-back) --width $(WIDTH) \
>   --threads 1 $(MORE) --resume --out $(@D)

run/nets/table.txt: $(RUNS:%=run/nets/%/run.json)
> $(GLASS_NET)/table $^ --csv run/nets/table.csv > $@.part
> mv $@.part $@

run/weights/run.json: run/set.json
> $(GLASS_NET)/train --set $(SET) --input $(WEIGHTS_INPUT) \
>   --light $(WEIGHTS_LIGHT) --loss scales --epochs $(EPOCHS) --width $(WIDTH) \
>   $(MORE) --resume --out $(@D)

# Exit status 1: scales that are not honest. The table is there all the same.
run/weights/reliability.txt: run/weights/run.json
> glass-net --weights $(@D) --reliability $(SET) > $@.part; \
>   status=$$?; mv $@.part $@; cat $@; exit $$status

clean:
> rm -rf run/nets run/weights

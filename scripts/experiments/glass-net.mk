# make -j2 -f glass-net.mk       table 2: which input says most of glass
# Networks on RGB, Stokes vectors and intensities behind polarizers, with the
# screen's light alone and with the room's, with and without normals of the
# back, SEEDS times each, on the set that glass.mk made. GLASS_NET is the folder
# scripts/glass-net of the sources; it needs Debian's python3-torch.
SET     = run/set
GLASS_NET = $(dir $(lastword $(MAKEFILE_LIST)))../glass-net
SEEDS   = 1 2 3
INPUTS  = rgb stokes intensities
LIGHTS  = bare lit
BACKS   = back front
EPOCHS  = 40
WIDTH   = 16
MORE    =

RUNS = $(foreach i,$(INPUTS),$(foreach l,$(LIGHTS),$(foreach b,$(BACKS),\
       $(foreach s,$(SEEDS),$i-$l-$b-$s))))
part = $(word $1,$(subst -, ,$2))

.RECIPEPREFIX = >
.SECONDARY:
.PHONY: all clean
all: run/nets/table.txt

$(RUNS:%=run/nets/%/run.json): run/nets/%/run.json: run/set.json
> $(GLASS_NET)/train --set $(SET) --input $(call part,1,$*) \
>   --light $(call part,2,$*) --seed $(call part,4,$*) --epochs $(EPOCHS) \
>   $(if $(filter front,$(call part,3,$*)),--without-back) --width $(WIDTH) \
>   --threads 1 $(MORE) --resume --out $(@D)

run/nets/table.txt: $(RUNS:%=run/nets/%/run.json)
> $(GLASS_NET)/table $^ --csv run/nets/table.csv > $@.part
> mv $@.part $@

clean:
> rm -rf run/nets

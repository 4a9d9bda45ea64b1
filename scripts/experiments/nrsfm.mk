# make -j2 -f nrsfm.mk        the factorial experiment, below run/
# 5 deformations x 6 camera paths x 2 cameras x {with, without} missing tracks,
# each solved by every solver that can take it, held against its truth; what
# decides the error is in run/tables and run/factorial.html.
KINDS   = articulated bending deflation stretching tearing
PATHS   = circle half-circle line flyby zigzag tricky
CAMERAS = orthographic perspective
MISSING = with without
SOLVERS = all
SET     =
FRAMES  = 40
POINTS  = 60
MODEL   = pairs

CELLS = $(foreach k,$(KINDS),$(foreach p,$(PATHS),$(foreach c,$(CAMERAS),\
        $(foreach m,$(MISSING),$k-$p-$c-$m))))

.RECIPEPREFIX = >
.SECONDEXPANSION:
.PHONY: all clean
all: run/factorial.html

# One simulation for all cells of a kind. --resume keeps the files that an
# interrupted call has finished.
$(KINDS:%=run/%.json): run/%.json: | run
> nrsfm-make --kind $* $(PATHS:%=--path %) $(CAMERAS:%=--camera %) \
>   $(MISSING:%=--missing %) --frames $(FRAMES) --points $(POINTS) \
>   --threads 1 --resume --out run/sequences -o $@

# 2: some solvers failed on this sequence; its notes say why.
$(CELLS:%=run/%.json): run/%.json: run/$$(firstword $$(subst -, ,$$*)).json
> nrsfm-solve $(SOLVERS:%=--solver %) $(SET:%=--set %) --sequence $* \
>   --threads 1 --resume --out run/answers -i $< -o $@ || test $$? -eq 2

$(CELLS:%=run/%.csv): run/%.csv: run/%.json
> nrsfm-eval --measure robust-rms --centre --draws 0 --threads 1 \
>   --log-level error --csv $@ -i $< > /dev/null

run/factorial.html: $(CELLS:%=run/%.csv)
> nrsfm-eval $(^:%=--table %) --model '$(MODEL)' --force --out run/tables \
>   --html $@ > /dev/null

run:
> mkdir -p run

clean:
> rm -rf run

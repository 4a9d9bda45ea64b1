# make -j2 -f print-contrast.mk     a wished contrast, printed twice: run/table.txt
# A plate whose ridges spell a data matrix shall show the contrast WISH when it
# lies and when it is turned. Its structure is found for the printer as it is
# believed to be; the layers are printed, in simulation, by the printer as it is
# (another growth, more spread); the print is photographed by render before and
# after a quarter turn, and contrast measures the photographs. What is missing
# is added to the wish, and the plate is printed again.
WISH      = 0.4
INCIDENCE = 30deg
TEXT      = GONIO
SPP       = 64
SCRIPT    = print_contrast.py

.RECIPEPREFIX = >
.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all clean
all: run/table.txt

run/believed.json run/actual.json run/plate.obj &:
> mkdir -p run && python3 $(SCRIPT) begin run

run/wish-1.txt: run/believed.json
> echo $(WISH) > $@
run/wish-2.txt: run/wish-1.txt run/measured-1.json
> python3 $(SCRIPT) next $(WISH) $^ > $@

run/design-%.json: run/wish-%.txt run/believed.json
> dlp-slice --wish contrast=$$(cat $<) --incidence $(INCIDENCE) --printer run/believed.json \
>   --out run/design-$* --force -o $@
run/sent-%.json: run/design-%.json run/plate.obj
> dlp-slice run/plate.obj --unit mm --printer run/believed.json --code $(TEXT) \
>   --structure "$$(python3 $(SCRIPT) structure $<)" --out run/sent-$* --force -o $@
run/printed-%.json: run/sent-%.json run/actual.json
> dlp-slice --sent run/sent-$*/layers.zip --printer run/actual.json --points 2 --out run/printed-$* --force -o $@
run/session-%.json: run/printed-%.json run/sent-%.json
> python3 $(SCRIPT) session $^ $(INCIDENCE) > run/scene-$*.json
> render run/scene-$*.json --spp $(SPP) --record --out run/photos-$* --force -o $@
run/measured-%.json: run/session-%.json
> contrast measure $< --out run/measured-$* --force -o $@ || test $$? -eq 1

run/table.txt: run/measured-1.json run/measured-2.json
> python3 $(SCRIPT) table $(WISH) run/wish-1.txt run/wish-2.txt $^ | tee $@
clean:
> rm -rf run

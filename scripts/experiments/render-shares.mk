# make -j2 -f render-shares.mk    one picture in shares: run/IMAGE.exr
# Each share takes SHARE of each pixel's SPP samples; joined they are the very
# file that one call would have written. SHARE is a multiple of 64, or of a
# sixteenth of SPP where that is a power of two. OPTIONS are render's, such as
# --stokes or --seed 2. Without a SCENE a built-in one is rendered.
SCENE   = run/knot.json
IMAGE   = view-0-lamp-0
SPP     = 1024
SHARE   = 128
THREADS = 1
OPTIONS =

RANGES  = $(shell a=0; while [ $$a -lt $(SPP) ]; do b=$$((a + $(SHARE))); \
          [ $$b -le $(SPP) ] || b=$(SPP); echo $$a-$$b; a=$$b; done)
SHARES  = $(RANGES:%=run/%/$(IMAGE).exr)

.RECIPEPREFIX = >
.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all clean
all: run/$(IMAGE).exr

run/knot.json: | run
> render --specimen knot --out run/knot -o $@

# An interrupted share goes on where it was.
$(SHARES): run/%/$(IMAGE).exr: $(SCENE) | run
> render $< --image $(IMAGE) --spp $(SPP) --samples $(subst -,:,$*) $(OPTIONS) \
>   --threads $(THREADS) --resume --out $(@D) > /dev/null

run/$(IMAGE).exr: $(SCENE) $(SHARES)
> render --merge --force --out run $^ -o run/$(IMAGE).json

run:
> mkdir -p run

clean:
> rm -rf run

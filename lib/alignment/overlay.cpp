// See overlay.h.
#include "alignment/overlay.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "io/picture.h"
#include "report/page.h"

namespace gonio::alignment {
std::string overlay_svg(const AlignmentInput& in, const Setting& setting, const std::vector<std::size_t>& sightings,
                        const std::vector<SightingFit>& fits, const io::Image& picture) {
  const camera::CameraModel& model =
      in.models[setting.stations[in.question.sightings[sightings.front()].subject.station].lens];
  const int width = model.width_px(), height = model.height_px();
  std::string svg =
      format("<svg viewBox=\"-0.5 -0.5 %d %d\" width=\"100%%\" style=\"background:#888\" role=\"img\">", width, height);
  if (picture.pixels() > 0)
    svg += format(
               "<image x=\"-0.5\" y=\"-0.5\" width=\"%d\" height=\"%d\" style=\"image-rendering:pixelated\" "
               "href=\"data:image/png;base64,",
               width, height) +
           report::base64(io::encode_png(picture)) + "\"/>";
  const double line = std::max(0.6, width / 500.0);
  for (const std::size_t k : sightings) {
    const Sighting& seen = in.question.sightings[k];
    const std::size_t lens = setting.stations[seen.subject.station].lens;
    const ModelRim rim(setting, seen.subject);
    std::string path;
    Vec2 last{HUGE_VAL, 0};
    for (const RimPiece& piece : rim.pieces()) {
      const Vec2 a = in.bent(lens, piece.from), b = in.bent(lens, piece.to);
      if (!(norm(a - last) < 1e-6)) path += format("M%.2f %.2f", a.x, a.y);
      path += format("L%.2f %.2f", b.x, b.y), last = b;
    }
    const char* colour = seen.subject.lamp ? "#ffb000" : "#00d5ff";
    svg += format("<path fill=\"none\" stroke=\"%s\" stroke-width=\"%.2f\" d=\"", colour, line) + path + "\"/>";
    path.clear();
    for (std::size_t i = 0; i < fits[k].weight.size(); ++i) {
      if (!in.rims[k].in_picture[i].counts || fits[k].weight[i] > 0.1) continue;
      const Vec2 p = in.rims[k].in_picture[i].pixel;
      path += format("M%.2f %.2fh0", p.x, p.y);
    }
    if (!path.empty())
      svg += format("<path fill=\"none\" stroke=\"#ff3030\" stroke-linecap=\"round\" stroke-width=\"%.2f\" d=\"",
                    1.6 * line) +
             path + "\"/>";
  }
  return svg + "</svg>";
}

}  // namespace gonio::alignment

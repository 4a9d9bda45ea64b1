// A luminaire from an IES LM-63 file (light/ies.h): a point whose intensity is watt_per_sr in the brightest direction
// and follows the file's candela elsewhere, bilinear in both angles.
#include "light/ies.h"

#include "light/number_file.h"

namespace gonio::light {
namespace {

enum : std::size_t { position_index, direction_index, up_index, intensity_index };

class IesModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "ies",
        .sentence = "A luminaire measured by its maker: intensity over two angles from an IES file.",
        .source = "IES LM-63-02; angles: IES LM-75-01",
        .parameters = {position_info("where the luminaire is, in the world frame"), direction_info(), up_info(),
                       intensity_info("radiant intensity in the brightest direction of linear red, green and blue")},
        .attachment = manifest::Attachment::table,
        .attachment_meaning = "IES LM-63 file",
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment& file,
                                   const std::string& place) const override {
    const auto v = manifest::values_of(info(), parameters, place);
    return aimed_lamp(v[position_index], lamp_frame(v[direction_index], v[up_index], place), v[intensity_index], 0,
                      tabulated_lobe(ies_grid(text_of(file.path, place), file.path.string())));
  }
};

}  // namespace

const Model& ies() {
  static const IesModel model;
  return model;
}

}  // namespace gonio::light

// The field tables of what align says of rims, poses and lamps.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/alignment.h"

namespace gonio::manifest {

const std::vector<Field<Outline>>& outline_fields() {
  using O = Outline;
  static const std::vector<Field<O>> table{
      field("image", &O::image, "", "that shows the rim").needed(),
      field("object", &O::object, "", "whose rim or shadow it is: id in objects").needed(),
      field("kind", &O::kind, "", "of what").one_of({"object", "shadow"}).needed(),
      field("light", &O::light, "", "of a shadow: the lamp that casts it; left out: the image's only one"),
      field("mask", &O::mask, "", "picture: pixels above a half belong to it"),
      field("file", &O::file, "", "table of its points, by align"),
      field("points", &O::points, "", "points of the rim").range(0, infinite),
      field("left_out", &O::left_out, "", "of these, that count for nothing: caustics, reflections, errors of masks")
          .range(0, infinite),
      field("rms_px", &O::rms_px, "px", "normal offset of what counts from the aligned model").range(0, infinite),
      field("mean_px", &O::mean_px, "px", "mean of these offsets, outwards"),
      field("explained", &O::explained, "", "share of the model's rim that has points beside it").range(0, 1)};
  return table;
}

const std::vector<Field<AlignedLight>>& aligned_light_fields() {
  using L = AlignedLight;
  static const std::vector<Field<L>> table{
      field("light", &L::light, "", "its name").needed(),
      field("images", &L::images, "", "of a light that a robot's tool carries: those taken while it stood there"),
      field("position_m", &L::position_m, "m", "of its centre, in the world"),
      field("covariance_m2", &L::covariance_m2, "m^2", "of the position, 3 x 3, row by row"),
      field("radius_m", &L::radius_m, "m", "from the width of penumbrae").range(0, infinite),
      sigma_field(&L::sigma)};
  return table;
}

const std::vector<Field<AlignedCamera>>& aligned_camera_fields() {
  using C = AlignedCamera;
  static const std::vector<Field<C>> table{
      field("camera", &C::camera, "", "its name").needed(),
      field("images", &C::images, "", "that it took from there"),
      field("world_from_camera", &C::world_from_camera, "", "takes the camera's to world coordinates"),
      field("covariance", &C::covariance, "",
            "6 x 6, row by row: of a small motion (rotation vector in rad, then m) in the world at the camera"),
      field("focal_factor", &C::focal_factor, "", "on the focal lengths that were stated").positive(),
      sigma_field(&C::sigma)};
  return table;
}

const std::vector<Field<AlignmentCandidate>>& alignment_candidate_fields() {
  using C = AlignmentCandidate;
  static const std::vector<Field<C>> table{
      field("world_from_object", &C::world_from_object, "", "takes the object's to world coordinates"),
      field("rms_px", &C::rms_px, "px", "normal offset of the rims' points").range(0, infinite),
      field("explained", &C::explained, "", "of the model's rims, seen").range(0, 1)};
  return table;
}

const std::vector<Field<AlignedPictures>>& aligned_pictures_fields() {
  using P = AlignedPictures;
  static const std::vector<Field<P>> table{
      field("verdict", &P::verdict, "", "is that what was written?").one_of({"taken", "refused"}).needed(),
      field("why", &P::why, "", "in words, where it was refused and the rims' answer stands"),
      field("photographs", &P::photographs, "", "that were compared").range(0, infinite),
      field("pixels", &P::pixels, "", "of these, inside objects and on the ground").range(0, infinite),
      field("independent", &P::independent, "", "independent values that these amount to").range(0, infinite),
      field("correlation_px", &P::correlation_px, "px", "side of a square that is one error").range(0, infinite),
      field("relative_error", &P::relative_error, "", "rms left over rms seen").range(0, infinite),
      field("relative_error_rims", &P::relative_error_rims, "", "the same at the rims' answer").range(0, infinite),
      field("chi2", &P::chi2, "", "of the move, by the rims' covariance").range(0, infinite),
      field("chi2_limit", &P::chi2_limit, "", "its 99 % point").range(0, infinite),
      field("numbers", &P::numbers, "", "free numbers that it counts").range(0, infinite),
      field("move_px", &P::move_px, "px", "of the rims' points, rms").range(0, infinite),
      field("sigma_px", &P::sigma_px, "px", "what the rims state of these points, rms").range(0, infinite),
      field("world_from_object", &P::world_from_object, "", "by rims and pictures, taken or not"),
      field("covariance", &P::covariance, "", "6 x 6, of that pose")};
  return table;
}

const std::vector<Field<Alignment>>& alignment_fields() {
  using A = Alignment;
  static const std::vector<Field<A>> table{
      field("object", &A::object, "", "id in objects").needed(),
      field("verdict", &A::verdict, "", "do the rims say where it is?")
          .one_of({"found", "ambiguous", "mirrored", "lost"})
          .needed(),
      field("why", &A::why, "", "in words, where it was not found"),
      field("world_from_object", &A::world_from_object, "", "takes the object's to world coordinates"),
      field("covariance", &A::covariance, "",
            "6 x 6, row by row: of a small motion (rotation vector in rad, then m) in the world at centre_m"),
      field("centre_m", &A::centre_m, "m", "middle of its box, in the world"),
      field("scale", &A::scale, "", "factors along the mesh's own axes"),
      sigma_field(&A::sigma),
      field("rms_px", &A::rms_px, "px", "offset of points that count").range(0, infinite),
      field("sigma_px", &A::sigma_px, "px", "of one point, by what is left").range(0, infinite),
      field("correlation_px", &A::correlation_px, "px", "of rim that is one error").range(0, infinite),
      field("explained", &A::explained, "", "of the model's rims, seen").range(0, 1),
      field("open", &A::open, "", "what no rim holds, in words"),
      field("candidates", &A::candidates, "", "where ambiguous: all poses that fit, best first"),
      field("lights", &A::lights, "", "that its shadows place"),
      field("cameras", &A::cameras, "", "cameras that were moved with it"),
      field("pictures", &A::pictures, "", "by align --picture")};
  return table;
}

GONIO_RECORD(Outline, outline_fields);
GONIO_RECORD(AlignedLight, aligned_light_fields);
GONIO_RECORD(AlignedCamera, aligned_camera_fields);
GONIO_RECORD(AlignmentCandidate, alignment_candidate_fields);
GONIO_RECORD(AlignedPictures, aligned_pictures_fields);
GONIO_RECORD(Alignment, alignment_fields);

}  // namespace gonio::manifest

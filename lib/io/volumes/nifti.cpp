// NIfTI-1 (nifti1.h, R. W. Cox et al. 2003): a head of 348 bytes in either order, samples in the same file (.nii,
// .nii.gz: "n+1") or in an .img beside it ("ni1").
//
// Units are said by xyzt_units; code 0 is "unknown", and then spacing and origin are not stated. Where the volume lies:
// the sform where it says scanner or aligned coordinates, else the qform; an sform to an atlas (Talairach, MNI) is no
// place of the object, and is taken only for its directions where there is no qform.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "io/little_endian.h"
#include "io/volume_grid.h"
#include "io/volume_header.h"
#include "io/volume_samples.h"

namespace gonio::io::volumes {
namespace {

constexpr std::size_t nifti_head_bytes = 348;
constexpr double same_length = 1e-3;  // pixdim against columns of the sform, in floats

// Places of fields, in bytes.
enum NiftiPlace : std::size_t {
  dim_at = 40,
  datatype_at = 70,
  bitpix_at = 72,
  pixdim_at = 76,
  vox_offset_at = 108,
  scl_slope_at = 112,
  scl_inter_at = 116,
  xyzt_units_at = 123,
  qform_code_at = 252,
  sform_code_at = 254,
  quatern_at = 256,
  qoffset_at = 268,
  srow_at = 280,
  magic_at = 344
};

struct NiftiHead {
  std::string bytes;
  bool big = false;
  std::string place;

  template <class T>
  T at(std::size_t offset) const {
    if (!big) return stored_at<T>(bytes, offset);
    std::string turned = bytes.substr(offset, sizeof(T));
    std::reverse(turned.begin(), turned.end());
    return stored_at<T>(turned, 0);
  }
  double real(std::size_t offset) const { return static_cast<double>(at<float>(offset)); }
  int integer(std::size_t offset) const { return at<std::int16_t>(offset); }
  std::string_view magic() const { return std::string_view(bytes).substr(magic_at, 4); }
};

bool is_nifti(std::string_view head) {
  if (head.size() < nifti_head_bytes) return false;
  const auto magic = head.substr(magic_at, 3);
  if (magic == "n+1" || magic == "ni1") return true;
  const auto second = head.substr(4, 3);  // NIfTI-2, to refuse it by its name
  return second == "n+2" || second == "ni2";
}

bool begins_as_nifti(const std::filesystem::path&, std::string_view beginning, const VolumeWish&) {
  return is_nifti(beginning) || is_nifti(beginning_inflated(beginning, nifti_head_bytes));
}

NiftiHead nifti_head(std::string bytes, const std::string& place) {
  NiftiHead head{.bytes = std::move(bytes), .place = place};
  if (head.bytes.size() < nifti_head_bytes || !is_nifti(head.bytes)) refuse_volume(place, "ends within its head");
  if (head.at<std::int32_t>(0) == 540 || head.at<std::int32_t>(0) == 0x1c020000)
    refuse_volume(place, "is NIfTI-2", "write it as NIfTI-1");
  head.big = head.at<std::int32_t>(0) != static_cast<std::int32_t>(nifti_head_bytes);
  if (head.at<std::int32_t>(0) != static_cast<std::int32_t>(nifti_head_bytes))
    refuse_volume(place, "states a head of another length than 348 bytes in either order of bytes");
  return head;
}

VoxelType nifti_type(const NiftiHead& head) {
  static const std::map<int, VoxelType> types = {{2, VoxelType::u8},    {4, VoxelType::i16},  {8, VoxelType::i32},
                                                 {16, VoxelType::f32},  {64, VoxelType::f64}, {256, VoxelType::i8},
                                                 {512, VoxelType::u16}, {768, VoxelType::u32}};
  const int code = head.integer(datatype_at);
  const auto found = types.find(code);
  if (found == types.end())
    refuse_volume(head.place, "has samples of NIfTI's datatype " + std::to_string(code),
                  "integers of 8, 16 and 32 bits, float32 and float64 are read");
  if (const int bits = head.integer(bitpix_at); bits != static_cast<int>(8 * bytes_of(found->second)))
    refuse_volume(head.place,
                  std::string("states ") + name_of(found->second) + " samples of " + std::to_string(bits) + " bits");
  return found->second;
}

void read_nifti_size(const NiftiHead& head, VolumeHead& out) {
  const int dimensions = head.integer(dim_at);
  if (dimensions < 1 || dimensions > 7)
    refuse_volume(head.place, "has " + std::to_string(dimensions) + " axes, and a volume has 3");
  for (int a = 1; a <= 7; ++a) {
    const int n = a <= dimensions ? head.integer(dim_at + 2 * static_cast<std::size_t>(a)) : 1;
    if (a <= 3)
      out.size[static_cast<std::size_t>(a - 1)] = checked_side(n, head.place);
    else if (n > 1)
      refuse_volume(head.place, "has " + std::to_string(n) + " volumes along axis " + std::to_string(a),
                    "write one channel and one moment to a file of its own");
  }
}

// nifti1.h, METHOD 2: b, c, d are the imaginary parts of a unit quaternion; qfac = -1 turns k about.
Mat3 qform_axes(const NiftiHead& head) {
  const double b = head.real(quatern_at), c = head.real(quatern_at + 4), d = head.real(quatern_at + 8);
  const double rest = 1 - (b * b + c * c + d * d);
  if (!(rest > -1e-5)) refuse_volume(head.place, "has a quaternion in its qform that turns nothing");
  const double a = std::sqrt(std::max(0.0, rest)), scale = 1 / std::sqrt(a * a + b * b + c * c + d * d);
  const double w = a * scale, x = b * scale, y = c * scale, z = d * scale;
  const double k = head.real(pixdim_at) < 0 ? -1 : 1;
  return {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), k * 2 * (x * z + w * y), 2 * (x * y + w * z),
           w * w + y * y - x * x - z * z, k * 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
           k * (w * w + z * z - x * x - y * y)}};
}

double nifti_unit(const NiftiHead& head) {
  const int code = static_cast<unsigned char>(head.bytes[xyzt_units_at]) & 7;
  if (code > 3) refuse_volume(head.place, "states its lengths in NIfTI's unit " + std::to_string(code));
  return code == 1 ? 1 : code == 2 ? 1e-3 : code == 3 ? 1e-6 : 0;
}

StatedGrid nifti_grid(const NiftiHead& head) {
  StatedGrid grid;
  const Vec3 pixdim{head.real(pixdim_at + 4), head.real(pixdim_at + 8), head.real(pixdim_at + 12)};
  const int qform = head.integer(qform_code_at), sform = head.integer(sform_code_at);
  grid.unit_m = nifti_unit(head);
  if (qform > 0 && !(sform == 1 || sform == 2)) {
    grid.axes = qform_axes(head);
    grid.origin = Vec3{head.real(qoffset_at), head.real(qoffset_at + 4), head.real(qoffset_at + 8)};
  } else if (sform > 0) {
    Mat3 steps;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) steps(r, c) = head.real(srow_at + static_cast<std::size_t>(16 * r + 4 * c));
    set_steps(grid, steps);
    for (int a = 0; (sform == 1 || sform == 2) && a < 3; ++a)
      if (!(std::abs((*grid.spacing)[a] - pixdim[a]) <= same_length * std::abs(pixdim[a])))
        refuse_volume(head.place,
                      "states a spacing of " + spacing_text(pixdim, "") + " in pixdim and of " +
                          spacing_text(*grid.spacing, "") + " in its sform",
                      "correct the one that is wrong");
    if (sform <= 2) grid.origin = Vec3{head.real(srow_at + 12), head.real(srow_at + 28), head.real(srow_at + 44)};
  }
  grid.spacing = pixdim;
  return grid;
}

// nifti1.h: a slope of 0 means that the samples are the values; what is no number is taken likewise.
void read_nifti_scale(const NiftiHead& head, VolumeHead& out) {
  const double slope = head.real(scl_slope_at), intercept = head.real(scl_inter_at);
  if (!std::isfinite(slope) || slope == 0) return;
  if (!std::isfinite(intercept)) refuse_volume(head.place, "states an intercept of its values that is no number");
  out.slope = slope;
  out.intercept = intercept;
}

std::filesystem::path img_of(const std::filesystem::path& head) {
  for (const char* end : {".img", ".img.gz"}) {
    std::filesystem::path img = head;
    if (img.extension() == ".gz") img.replace_extension();
    img.replace_extension(end);
    std::error_code ignored;
    if (img != head && std::filesystem::exists(img, ignored)) return img;
  }
  throw Error(Exit::no_input, head.string(), "has its samples in an .img, which is not beside it",
              "put the two beside each other");
}

std::unique_ptr<VolumeSource> open_nifti(const std::filesystem::path& path, const VolumeWish& wish) {
  const std::string place = path.string(), beginning = beginning_of_file(path, 4096);
  const bool gzip = beginning.starts_with("\x1f\x8b");
  const NiftiHead stated = nifti_head(
      (gzip ? beginning_inflated(beginning, nifti_head_bytes) : beginning.substr(0, nifti_head_bytes)), place);
  VolumeHead head{.type = nifti_type(stated), .format = gzip ? "NIfTI-1, gzip" : "NIfTI-1", .files = {path}};
  read_nifti_size(stated, head);
  const std::uint64_t bytes = checked_volume_bytes(head, place);
  read_nifti_scale(stated, head);
  check_wish_of_described(head, wish, place);
  settle_grid(nifti_grid(stated), wish, head, place);
  const bool own = stated.magic().substr(0, 3) == "n+1";
  const double offset = stated.real(vox_offset_at);
  const double least = own ? 352 : 0;
  if (!(offset >= least && offset < 0x1p40) || offset != std::floor(offset)) {
    if (!(own && offset == 0))  // written by some for "behind the head"
      refuse_volume(place, "states that its samples begin at byte " + shortest_text(offset) + ", and from " +
                               shortest_text(least) + " on is possible");
  }
  DataFile data{.path = path, .deflated = gzip};
  if (!own) {
    data.path = img_of(path);
    data.deflated = beginning_of_file(data.path, 2) == "\x1f\x8b" && data.path.extension() == ".gz";
    head.files.push_back(data.path);
  }
  const auto before = static_cast<std::uint64_t>(std::max(offset, least));
  (data.deflated ? data.skip : data.first) = before;
  return linear_volume(std::move(head), bytes_of_files({data}, bytes), stated.big);
}

}  // namespace

const VolumeFormat& nifti() {
  static const VolumeFormat format{
      .name = "NIfTI-1",
      .sentence =
          ".nii, .nii.gz, .hdr with .img: lengths in the units of xyzt_units; where these are unknown, the "
          "spacing must be said with --voxel",
      .mine = begins_as_nifti,
      .open = open_nifti,
      .order = 20};
  return format;
}

}  // namespace gonio::io::volumes

#pragma once

namespace hqslam::slam {

/// How well the scans of a drive fit the map in which they are registered, beside how well those
/// of the map's own drive did: corridors and stairs of another building are alike, so a scan that
/// is registered there may fit as well as some scan of the map's drive, but many do not.
class MapFit {
 public:
  MapFit() = default;
  /// In a given map; SavedMap::close_ratio, 0: unknown, nothing is doubted.
  explicit MapFit(double given_close_ratio) : given_(given_close_ratio) {}

  /// MappingResult::close_ratio of a registered scan.
  void add(double close_ratio);
  double mean_close_ratio() const;  ///< 0 without a scan

  bool is_doubtful() const;  ///< by the last twenty scans or so

 private:
  double given_ = 0.0;
  double sum_ = 0.0;
  int scans_ = 0;
  double recent_ = 0.0;
};

}  // namespace hqslam::slam

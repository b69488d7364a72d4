#include "train/training_page.h"

#include "pages/page.h"

namespace hqslam::tools {

std::string training_html(const std::string& title, const std::vector<nn::CurvePoint>& curve) {
  PageJson data = {{"title", title}};
  for (const char* key : {"step", "loss", "mae_all", "mae_valid", "wrong"}) {
    data[key] = PageJson::array();
  }
  for (const nn::CurvePoint& point : curve) {
    const nn::Validation& v = point.validation;
    data["step"].push_back(point.step);
    data["loss"].push_back(point.loss);
    data["mae_all"].push_back(v.network.mae_all_m / v.linear.mae_all_m);
    data["mae_valid"].push_back(v.network.mae_valid_m / v.linear.mae_valid_m);
    data["wrong"].push_back(v.network.wrong_share / v.linear.wrong_share);
  }
  return page_html("training", std::move(data));
}

}  // namespace hqslam::tools

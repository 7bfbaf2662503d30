// Finds every pixel's history in the previous frame: bilinear taps, each validated by itself.
// Source: SVGF (Schied et al. 2017), section 4.1; unlike public implementations every tap gets its own bounds test.
//
// Where an image comes in slower than a pixel a frame, the pixels at its edge find a part of their taps beyond it. The
// rest stands for all of the history, as is usual, so the edge keeps what was there while new image passes, and its
// neighbours fill with it. That can be bounded: with the share o of the footprint beyond the edge, and a reach P > 0,
//
//   [ledger edge]  d <- d (1 - o / P)
//
// what it remembers is on average younger than P / o frames, the time in which P pixels come in. What that gains and
// costs: docs/decisions.md, "The image's edge".
#pragma once

#include "core/guide.h"
#include "twohistory/taps.h"

namespace twohistory {

struct ReprojectionParameters {
  float depthTolerance = 4;              ///< times the depth change across one pixel
  float relativeDepthTolerance = 0.01f;  ///< plus this times the depth
  float normalCosine = 0.9f;             ///< least cosine between the normals
  float leastWeight = 0.01f;             ///< of the valid taps' bilinear weights; below it the history is reset
  float edgeReach = 0;                   ///< P in pixels; 0: what is inside stands for all of the history
};

template <class V>
void describe(V& v, ReprojectionParameters& p) {
  v("depthTolerance", p.depthTolerance, "times the depth change across one pixel", 0.0, 1e6);
  v("relativeDepthTolerance", p.relativeDepthTolerance, "times the depth, added to depthTolerance", 0.0, 1e6);
  v("normalCosine", p.normalCosine, "least cosine between now's and before's normal", -1.0, 1.0);
  v("leastWeight", p.leastWeight, "bilinear weight of the valid taps below which history is reset", 0.0, 1.0);
  v("edgeReach", p.edgeReach, "pixels of image that may come in before the edge has forgotten; 0 = it never does", 0.0,
    1e6);
}

/// out: the taps of every pixel of `now` in `before` (same size). Pixels without surface get none.
void reproject(const core::Guide& now, const core::Guide& before, const ReprojectionParameters& parameters,
               core::ImageView<Taps> out);

}  // namespace twohistory

// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace formats {

// For A4 on paper and a column of the same width on screen.
inline constexpr const char* kCertificateStyle = R"css(
@page { size: A4; margin: 14mm 15mm 16mm; @bottom-right { content: counter(page) " of " counter(pages);
  font: 8pt "Liberation Sans", Arial, sans-serif; color: #667; } }
* { box-sizing: border-box; }
body { font: 10pt/1.4 "Liberation Sans", Arial, Helvetica, sans-serif; color: #1c1c1c; max-width: 180mm; margin: 8mm auto;
  padding: 0 2mm; }
header { display: flex; justify-content: space-between; align-items: flex-end; border-bottom: 2.5pt solid #1f3c5c;
  margin-bottom: 4mm; }
h1 { font-size: 21pt; font-weight: 600; margin: 0; color: #1f3c5c; }
h2 { font-size: 12.5pt; color: #1f3c5c; border-bottom: .5pt solid #b8c4d0; margin: 6mm 0 2mm; padding-bottom: 1mm;
  break-after: avoid; }
h3 { font-size: 10.5pt; margin: 2mm 0 1mm; break-after: avoid; }
p { margin: 1.5mm 0; }
h1.appendices { break-before: page; font-size: 15pt; }
.site { font-size: 12pt; margin: 0 0 2mm; }
.maker { color: #667; font-size: 9pt; padding-bottom: 2mm; }
.note { color: #555; font-size: 8.5pt; }
.lead { break-after: avoid; }
.red { color: #b3141b; }
.untied { background: #b3141b; color: white; font-weight: 600; padding: 3mm 4mm; margin: 3mm 0; }
blockquote { margin: 2mm 0; padding: 2mm 4mm; border-left: 3pt solid #1f3c5c; background: #f3f6f9; }
table { border-collapse: collapse; width: 100%; font-size: 8.5pt; margin: 1.5mm 0; }
th { text-align: left; font-weight: 600; color: #333; border-bottom: 1pt solid #8a97a5; padding: 1mm 1.5mm;
  vertical-align: bottom; }
td { border-bottom: .4pt solid #d9dfe5; padding: .7mm 1.5mm; vertical-align: top; }
tr, .short { break-inside: avoid; }
td code { white-space: nowrap; }
.small td:nth-child(4) code { white-space: normal; }
thead { display: table-header-group; }
.num { text-align: right; font-variant-numeric: tabular-nums; }
.flag td { background: #fbe9e9; }
.verdicts { display: flex; gap: 4mm; margin: 2mm 0; }
.verdict { flex: 1; border: 1pt solid; padding: 2mm 4mm; display: flex; justify-content: space-between;
  align-items: center; gap: 3mm; }
.verdict b { font-size: 15pt; text-transform: uppercase; white-space: nowrap; }
.good { border-color: #2c7a2c; background: #eef7ee; color: #1d5a1d; }
.bad { border-color: #b3141b; background: #fbeeee; color: #b3141b; }
.open { border-color: #8a97a5; background: #f4f5f6; color: #555; }
.signature { display: flex; gap: 8mm; margin: 11mm 0 3mm; break-inside: avoid; }
.signature div { flex: 1; border-top: .7pt solid #333; font-size: 8pt; color: #555; padding-top: 1mm; }
figure { margin: 2mm 0; break-inside: avoid; }
figcaption { font-size: 8.5pt; color: #555; }
svg { width: 100%; height: auto; display: block; }
.halo { paint-order: stroke; stroke: white; stroke-width: 2.5px; stroke-linejoin: round; font-size: 10px; }
.pair { display: table; width: 100%; break-inside: avoid; }
.pair > * { display: table-cell; vertical-align: top; }
.pair figure { width: 36%; padding-right: 2%; }
.pair table { font-size: 7.8pt; line-height: 1.25; }
.pair td { padding: .45mm 1.5mm; }
.features figure { display: inline-block; width: 17%; margin: 0 .8% 2mm; vertical-align: top; }
.features figcaption { font-size: 7pt; }
.two figure { display: inline-block; width: 48%; margin: 0 .5%; vertical-align: top; }
@media print { body { margin: 0; padding: 0; max-width: none; } }
.small table { font-size: 7.2pt; }
code { font: 90% "Liberation Mono", monospace; overflow-wrap: anywhere; }
ul { margin: 1mm 0; padding-left: 5mm; font-size: 9pt; }
)css";

}  // namespace formats

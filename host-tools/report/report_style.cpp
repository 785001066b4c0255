/* SPDX-License-Identifier: Apache-2.0 */
/* Light, in the reader's own fonts; drawings shrink to the paper's width and are not torn apart by
 * a page's end. */
#include "report_parts.hpp"

const char *report_style()
{
    return R"css(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #fff; color: #1a1a1a;
       font: 15px/1.45 system-ui, "Liberation Sans", "DejaVu Sans", Arial, sans-serif; }
main { max-width: 1160px; margin: 0 auto; padding: 24px 28px 48px; }
h1 { font-size: 26px; margin: 0 0 16px; overflow-wrap: anywhere; }
h2 { font-size: 19px; margin: 34px 0 8px; padding-bottom: 4px; border-bottom: 1px solid #c8c8c8; }
h3 { font-size: 15px; margin: 18px 0 6px; }
p { margin: 6px 0; max-width: 82ch; }
.verdict { border: 1px solid #c8c8c8; border-left: 12px solid #555; border-radius: 4px;
           padding: 12px 18px; }
.verdict h2 { border: 0; margin: 0 0 4px; padding: 0; font-size: 22px; }
.verdict.good { border-left-color: #0072b2; background: #eff6fb; }
.verdict.care { border-left-color: #e69f00; background: #fdf6e6; }
.verdict.again { border-left-color: #a33b00; background: #fbeee8; }
.verdict li { margin: 4px 0; max-width: 86ch; }
.verdict ul { margin: 6px 0; padding-left: 22px; }
.tiles { display: flex; flex-wrap: wrap; gap: 12px; margin: 16px 0 0; }
.tile { flex: 1 1 170px; border: 1px solid #c8c8c8; border-radius: 4px; padding: 8px 14px; }
.tile b { display: block; font-size: 22px; font-weight: 600; }
.tile small { color: #555; }
table { border-collapse: collapse; margin: 8px 0 12px; font-variant-numeric: tabular-nums; }
th, td { padding: 3px 12px 3px 0; text-align: right; vertical-align: top;
         border-bottom: 1px solid #e4e4e4; }
th { font-weight: 600; vertical-align: bottom; color: #333; }
th.w, td.w { text-align: left; }
td.w { max-width: 30em; overflow-wrap: break-word; }
tr.sum td { font-weight: 600; }
td svg { vertical-align: middle; }
.row { display: flex; flex-wrap: wrap; gap: 8px 24px; align-items: flex-start; }
figure { margin: 8px 0; break-inside: avoid; }
figcaption { color: #444; font-size: 13px; max-width: 540px; overflow-wrap: anywhere; }
.small figcaption { max-width: 258px; font-size: 12px; }
.note { color: #444; font-size: 13px; }
svg { max-width: 100%; height: auto; font: 12px system-ui, "Liberation Sans", "DejaVu Sans", Arial,
      sans-serif; fill: #1a1a1a; }
svg .frame { fill: #fff; stroke: #777; stroke-width: 1; }
svg .cell { stroke: #fff; stroke-width: 1; }
svg .empty { fill: #f4f4f4; stroke: #b0b0b0; stroke-width: 1; stroke-dasharray: 3 2; }
svg .bar { fill: #4c8fbd; }
svg .bar-back { fill: #eeeeee; }
svg .node { fill: none; stroke: #6f9fc0; stroke-width: 0.8; }
svg .mean { fill: none; stroke: #0b3c6f; stroke-width: 1.8; }
svg .dot { fill: #0b3c6f; }
svg .outlier { fill: none; stroke: #d55e00; stroke-width: 1.2; }
svg .scale { fill: none; stroke: #1a1a1a; stroke-width: 2; }
svg .grid { fill: none; stroke: #cfcfcf; stroke-width: 0.8; }
svg .edge { fill: none; stroke: #888; stroke-width: 1.2; }
svg .drop { fill: none; stroke: #b5b5b5; stroke-width: 0.8; stroke-dasharray: 2 3; }
svg .camera { fill: #9cc4df; fill-opacity: 0.45; stroke: #0b3c6f; stroke-width: 1; }
svg .head { fill: #f3d9a0; fill-opacity: 0.7; stroke: #a87400; stroke-width: 1.2; }
svg .axis { fill: none; stroke: #1a1a1a; stroke-width: 1.4; }
svg .marker { fill: #1a1a1a; }
svg .light { fill: #fff; }
svg .halo { font-weight: 600; paint-order: stroke; stroke: #fff; stroke-width: 3px;
            stroke-linejoin: round; }
svg .quiet { fill: #555; }
svg .strong { font-weight: 600; }
@media print {
  @page { size: A4; margin: 14mm; }
  body { font-size: 8.5pt; }
  main { max-width: none; padding: 0; }
  h1 { font-size: 16pt; }
  h2 { font-size: 12pt; margin-top: 6mm; break-after: avoid; }
  h3 { font-size: 9.5pt; break-after: avoid; }
  .row { display: grid; grid-template-columns: 1fr 1fr; gap: 2mm 5mm; break-before: avoid; }
  .row.small { grid-template-columns: repeat(4, 1fr); gap: 2mm; break-before: auto; }
  figcaption, .small figcaption { max-width: none; font-size: 7.5pt; }
  .tiles { flex-wrap: nowrap; gap: 2mm; }
  .tile { flex: 1 1 0; padding: 1mm 2mm; }
  .tile b { font-size: 12pt; }
  .note { font-size: 7.5pt; }
  table { break-inside: avoid; }
  th, td { padding: 1px 7px 1px 0; }
  td svg { width: 70px; }
  .verdict, tr, figure, .tile { break-inside: avoid; }
  .verdict, .tile, svg { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)css";
}

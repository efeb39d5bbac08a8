" Vim syntax file for perilat laws (.plm). The lists of words are those of the compiler; a test compares them.
if exists("b:current_syntax")
  finish
endif
let s:save = &cpo
set cpo&vim

syntax case match
" words that begin a line
syntax match perilatFirst "^\s*\h\w*" contains=perilatStatement,perilatName
syntax match perilatName "\h\w*" contained
syntax keyword perilatStatement contained model end law for parameter constant option state damage function force moment energy stress strain yield flow output nonconservative include crack grow toward speed failed require accept rest rate field
" words that are never names
syntax keyword perilatReserved when otherwise jump in and or not by along returned on
syntax keyword perilatQuantity pi stretch stretch_rate theta_i theta_j twist length s spacing t V m m_i m_j area shell horizon weight n resolved direction u slip gap slip_rate dt strain strain_rate h K_I K_II energy_release angle_now speed_now rayleigh_speed shear_speed dilatational_speed
syntax keyword perilatFunction abs sqrt cbrt exp log log10 sin cos tan asin acos sinh cosh tanh atan2 sign soft_sign positive_part min max norm previous diff sum mean deviator virtual_work fit uniform_force uniform_stretch hooke principal trace dev J2 von_mises principal_direction product vector dot cross dyad tensor gradient correspondence transpose sym det inverse rotation
syntax keyword perilatKind central micropolar bond particle neighbour reference plane_stress plane_strain space irregular anisotropic continuum point tip
syntax keyword perilatConstant pi inf

syntax match perilatNumber "\<\d\+\(\.\d*\)\=\([eEdD][+-]\=\d\+\)\=" nextgroup=perilatUnit skipwhite
syntax match perilatNumber "\.\d\+\([eEdD][+-]\=\d\+\)\=" nextgroup=perilatUnit skipwhite
syntax match perilatUnit "\[[^]]*\]" contained
syntax region perilatString start=+"+ end=+"+ oneline
syntax match perilatOperator "\*\*\|[-+*/<>=:&|]\|[<>=/]="
" still to be written
syntax match perilatHole "?" nextgroup=perilatUnit skipwhite
syntax match perilatComment "!.*$" contains=perilatTodo
syntax match perilatDoc "!>.*$"
syntax keyword perilatTodo contained TODO FIXME

highlight default link perilatStatement Statement
highlight default link perilatReserved Keyword
highlight default link perilatQuantity Identifier
highlight default link perilatFunction Function
highlight default link perilatKind Type
highlight default link perilatConstant Constant
highlight default link perilatNumber Number
highlight default link perilatUnit Special
highlight default link perilatString String
highlight default link perilatOperator Operator
highlight default link perilatComment Comment
highlight default link perilatDoc SpecialComment
highlight default link perilatHole Todo
highlight default link perilatTodo Todo

let b:current_syntax = "perilat"
let &cpo = s:save
unlet s:save

(* Theorem 4 in lanes: two shielded vehicles that may count on precedence are never in a lane together. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Statement Ego Plan Apart Entry Shield Pair Yield.
Open Scope R_scope.

(** * One that creeps behind *)

(* What a follower needs to stop, at least: it goes on for its reaction time, and then brakes. *)
Lemma safe_gap_least k w v : valid k -> 0 <= w -> 0 <= v ->
  w * follower_reaction k + w * w / (follower_braking k + follower_braking k) - v * v / (hardest k + hardest k) <= safe_gap k w v
  /\ 0 <= safe_gap k w v.
Proof.
  intros ok w0 v0. rewrite safe_gap_nonneg by exact v0. split; [| apply Rmax_r].
  apply Rle_trans with (2 := Rmax_l _ _). apply Rplus_le_compat_r.
  rewrite rush_is. unfold rest_of, start. rewrite (Rmax_left w) by lra.
  assert (a0 : 0 < other_acceleration k) by (destruct ok; lra).
  assert (rho : 0 <= follower_reaction k) by (destruct ok; lra).
  assert (f0 : 0 < follower_braking k) by (destruct ok; lra).
  assert (fast : w <= speed (rushing {| distance := 0; speed := w |} (other_acceleration k) (other_max_speed k) (follower_reaction k))).
  { cbn. assert (0 <= other_acceleration k * follower_reaction k) by nra. cases; lra. }
  assert (far : w * follower_reaction k
    <= distance (rushing {| distance := 0; speed := w |} (other_acceleration k) (other_max_speed k) (follower_reaction k))).
  { cbn [distance speed rushing].
    set (x0 := Rmax (other_max_speed k) w). set (x1 := (x0 - w) / other_acceleration k).
    assert (w <= x0) by apply Rmax_r.
    assert (0 <= x1) by (unfold x1; apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
    destruct (Rmin_spec (follower_reaction k) x1) as [[? ->] | [? ->]].
    - rewrite Rmax_right by lra. assert (0 <= other_acceleration k * follower_reaction k * follower_reaction k) by
        (apply Rmult_le_pos; [apply Rmult_le_pos |]; lra). lra.
    - rewrite Rmax_left by lra. assert (0 <= other_acceleration k * x1 * x1) by (apply Rmult_le_pos; [apply Rmult_le_pos |]; lra).
      assert (w * (follower_reaction k - x1) <= x0 * (follower_reaction k - x1)) by (apply Rmult_le_compat_r; lra). lra. }
  set (r := rushing _ _ _ _) in *.
  assert (w * w / (follower_braking k + follower_braking k) <= speed r * speed r / (follower_braking k + follower_braking k)); [| lra].
  apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | apply Rmult_le_compat; lra].
Qed.

(* P7, for any two speeds: braking at b from up to r, behind one that is slower, takes no more than the safe gap and slack. *)
Lemma creeping_is_safe k r w v :
  valid k -> 0 <= r -> creeps_behind k r -> 0 <= v <= w -> w <= r ->
  (w * w - v * v) / (ego_braking k + ego_braking k) <= safe_gap k w v + slack k.
Proof.
  intros ok r0 P7 [v0 vw] wr. unfold creeps_behind in P7.
  destruct (safe_gap_least k w v ok ltac:(lra) v0) as [G G0].
  destruct (hardest_pos k ok) as (B0 & Bb & Bf).
  assert (b0 : 0 < ego_braking k) by (destruct ok; lra). assert (f0 : 0 < follower_braking k) by (destruct ok; lra).
  assert (rho : 0 <= follower_reaction k) by (destruct ok; lra). assert (sl : 0 < slack k) by (destruct ok; lra).
  unfold Rdiv in *. set (ib := / (ego_braking k + ego_braking k)) in *. set (jf := / (follower_braking k + follower_braking k)) in *.
  set (iB := / (hardest k + hardest k)) in *. set (rh := follower_reaction k) in *.
  assert (ib0 : 0 < ib) by (apply Rinv_0_lt_compat; lra).
  assert (vv : 0 <= v * v <= w * w) by (split; [apply Rmult_le_pos; lra | apply Rmult_le_compat; lra]).
  destruct (Rle_dec (follower_braking k) (ego_braking k)) as [le | gt].
  - (* The ego brakes no less than its follower. *)
    assert (ib <= jf) by (apply Rinv_le_contravar; lra).
    assert (E : iB = ib) by (unfold iB, ib, hardest; rewrite Rmax_left by lra; reflexivity). rewrite E in G.
    assert (w * w * ib <= w * w * jf) by (apply Rmult_le_compat_l; [apply Rmult_le_pos |]; lra).
    assert (0 <= w * rh) by (apply Rmult_le_pos; lra). lra.
  - assert (jf <= ib) by (apply Rinv_le_contravar; lra).
    assert (E : iB = jf) by (unfold iB, jf, hardest; rewrite Rmax_right by lra; reflexivity). rewrite E in G.
    assert (v * v * jf <= v * v * ib) by (apply Rmult_le_compat_l; [apply Rmult_le_pos |]; lra).
    assert (w * w * (ib - jf) <= w * rh + slack k); [| lra].
    (* It is convex in the speed, and holds at 0 and at r. *)
    destruct (Rle_lt_dec (w * (ib - jf)) rh) as [small | large].
    + assert (w * (w * (ib - jf)) <= w * rh) by (apply Rmult_le_compat_l; lra). lra.
    + assert (w * (w * (ib - jf) - rh) <= r * (r * (ib - jf) - rh)); [| lra].
      assert (w * (ib - jf) <= r * (ib - jf)) by (apply Rmult_le_compat_r; lra).
      apply Rmult_le_compat; lra.
Qed.

(* Who brakes at b from up to r, the safe gap and slack behind one that does not brake harder, stays behind. *)
Lemma creeps_behind_leader k r s v t w x q gap :
  valid k -> 0 <= r -> creeps_behind k r -> motion s v -> motion t w -> x <= q ->
  speeds_up_at_most v (- ego_braking k) x q ->
  (forall p p', x <= p -> p <= p' -> p' <= q -> w p - ego_braking k * (p' - p) <= w p') ->
  v x <= r -> safe_gap k (v x) (w x) + slack k <= gap -> s q - s x <= t q - t x + gap.
Proof.
  intros ok r0 P7 ms mt le up gentle slow G.
  pose proof (forwards s v ms x) as v0. pose proof (forwards t w mt x) as w0.
  assert (b0 : 0 < ego_braking k) by (destruct ok; lra). assert (sl : 0 < slack k) by (destruct ok; lra).
  set (b := ego_braking k) in *.
  assert (fast : forall p, x <= p <= q -> v p <= Rmax 0 (v x - b * (p - x))).
  { intros p h. pose proof (up x p ltac:(lra) ltac:(lra) ltac:(lra)). replace (v x - b * (p - x)) with (v x + - b * (p - x)) by ring. lra. }
  assert (least_ : forall p, x <= p <= q -> w x - b * (p - x) <= w p) by (intros; apply gentle; lra).
  destruct (Rle_lt_dec (v x) (w x)) as [slower | faster].
  - destruct (safe_gap_least k (v x) (w x) ok v0 w0) as [_ G0].
    assert (s q - s x <= t q - t x); [| lra]. apply (gap_opens t w s v); auto.
    intros p h. pose proof (fast p h) as F. pose proof (least_ p h). pose proof (forwards t w mt p). revert F. cases; lra.
  - pose proof (creeping_is_safe k r (v x) (w x) ok r0 P7 ltac:(lra) slow) as C. fold b in C.
    assert (way : s q - s x <= t q - t x + (v x * v x - w x * w x) / (b + b)); [| lra].
    set (m := x + w x / b).
    assert (bm : b * (m - x) = w x) by (unfold m; field; lra).
    assert (xm : x <= m) by (unfold m; assert (0 <= w x / b) by (apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]); lra).
    assert (S : w x * w x / (b + b) = b * (m - x) * (m - x) / 2) by (rewrite <- bm; field; lra).
    destruct (Rle_dec q m) as [early | late].
    + assert (line : forall p, x <= p <= q -> v p <= v x + - b * (p - x)).
      { intros p h. pose proof (fast p h) as F. assert (b * (p - x) <= b * (m - x)) by (apply Rmult_le_compat_l; lra). revert F. cases; lra. }
      pose proof (below_line s v (v x) (- b) x q ms le line) as A.
      pose proof (above_line t w (w x) (- b) x q mt le) as B.
      specialize (B ltac:(intros p h; pose proof (least_ p h); lra)).
      assert (D : s q - s x - (t q - t x) <= (v x - w x) * (q - x)) by lra.
      assert ((v x - w x) * (q - x) <= (v x - w x) * (m - x)) by (apply Rmult_le_compat_l; lra).
      assert ((v x - w x) * (m - x) <= (v x * v x - w x * w x) / (b + b)); [| lra].
      replace (m - x) with (w x / b) by (unfold m; ring).
      replace ((v x * v x - w x * w x) / (b + b)) with ((v x - w x) * (w x / b) + (v x - w x) * (v x - w x) / (b + b)) by (field; lra).
      assert (0 <= (v x - w x) * (v x - w x) / (b + b)); [| lra].
      apply Rmult_le_pos; [apply Rmult_le_pos; lra | left; apply Rinv_0_lt_compat; lra].
    + pose proof (stops_by s v b (v x) x q ms b0 le up (Rle_refl _)) as A.
      pose proof (above_line t w (w x) (- b) x m mt xm) as B.
      specialize (B ltac:(intros p h; pose proof (least_ p ltac:(lra)); lra)).
      pose proof (advances t w m q mt ltac:(lra)).
      assert (w x * (m - x) = b * (m - x) * (m - x)) by (rewrite bm; ring).
      replace ((v x * v x - w x * w x) / (b + b)) with (v x * v x / (b + b) - w x * w x / (b + b)) by (field; lra).
      lra.
Qed.

(** * What a shield sees to in a lane *)

(* What is not negative now was so before, or is so near enough. *)
Lemma just_before (f : R -> R) from g : continuous f g -> 0 < f g -> from < g -> exists p, from < p < g /\ forall x, p <= x <= g -> 0 < f x.
Proof.
  intros c pos lo.
  destruct (c (fun y => 0 < y)) as [e E].
  { exists (mkposreal (f g) pos). intros y h. unfold ball in h. cbn in h. unfold AbsRing_ball, abs, minus, plus, opp in h.
    cbn in h. apply Rabs_def2 in h. lra. }
  pose proof (cond_pos e) as e0.
  exists (g - Rmin (e / 2) ((g - from) / 2)). split; [cases; lra |]. intros x h. apply E.
  unfold ball. cbn. unfold AbsRing_ball, abs, minus, plus, opp. cbn. apply Rabs_def1; revert h; cases; lra.
Qed.

(* In the lane, and ahead by the band. *)
Definition leads (z : zone) (s t : R -> R) x := s_in z <= s x /\ lead_to z <= s x - t x.

Section Shield.
Variables (k : contract) (z : zone) (s v t w : R -> R) (mine theirs : R) (claimed : nat -> Prop).
Variables (tau c : nat -> R) (l : log) (b : nat -> bounds) (since : nat).
Hypothesis ok : valid k.
Hypothesis lz : lane z = true.
Hypothesis ms : motion s v.
Hypothesis mt : motion t w.
Hypothesis W : watches k (judged_in_lane k l c b z claimed since mine theirs) s v t w tau c l b since.

Let grid : on_grid k tau := its_calls _ _ _ _ _ _ _ _ _ _ _ W.
Let obey : obeys k v tau c := its_ego _ _ _ _ _ _ _ _ _ _ _ W.
Let log_ : true_log k l s v tau c := its_log _ _ _ _ _ _ _ _ _ _ _ W.
Let keeps : keeps_contract k w (tau since) := its_other _ _ _ _ _ _ _ _ _ _ _ W.
Let view : forall i, (since <= i)%nat -> known k t w (tau since) (tau i) (b i) := its_view _ _ _ _ _ _ _ _ _ _ _ W.
Let start_ : (1 <= since)%nat := its_start _ _ _ _ _ _ _ _ _ _ _ W.
Let ordered := calls_ordered k tau ok grid.

(* The plan in force counts on precedence from call i0 to call i. *)
Definition relies (i0 i : nat) :=
  (since <= i0 <= i)%nat /\ opened_in_lane k l b z claimed mine i0 /\ forall j, (i0 <= j < i)%nat -> carries_on k l c j.

Lemma seen_well i : (since <= i)%nat -> hold (b i) (t (tau i)) (w (tau i)).
Proof. intros h. apply (known_holds k t w (tau since)); auto. Qed.

(* A plan that is verified by the rule of precedence is verified. *)
Lemma in_lane_is_verified i : verified_in_lane k l c b z claimed theirs i -> verified_at k l c b z i.
Proof.
  intros [st | [st | [[_ en] _]]]; unfold verified_at, verified; [left; exact st | right | right]; rewrite lz;
    [left; exact st | right; exact en].
Qed.

(* Before the lane, or behind, or one of both has left; or it leads, or has led; or it counts on precedence. *)
Lemma outcome T u : tau since <= T <= u -> s T < s_in z ->
  s u < s_in z \/ s u - t u <= lead_from z \/ s_out z <= s u \/ t_out z <= t u \/
  (exists x, T <= x <= u /\ leads z s t x) \/ exists i0 i, relies i0 i /\ tau i <= u <= tau (S i).
Proof.
  intros [T0 lo] out. pose proof (advances s v (tau since) T ms T0).
  destruct (between_calls k tau ok grid since u ltac:(lra)) as (i & hi & hu).
  assert (D : judged k l c b z (fun _ => False) since i \/ exists i0, relies i0 i).
  { destruct (its_judgement _ _ _ _ _ _ _ _ _ _ _ W i hi) as [? | [? | [(i0 & h & ver & carried) | (i0 & h & op & carried)]]].
    - left; left; assumption.
    - left; right; left; assumption.
    - left; right; right; left. exists i0. split; [exact h |]. split; [apply in_lane_is_verified, ver | exact carried].
    - right. exists i0. split; [exact h |]. split; assumption. }
  destruct D as [j | (i0 & rel)]; [| do 5 right; exists i0, i; auto].
  destruct (judged_outcome k s v tau c l ok ms grid obey log_ t w b z (fun _ => False) since mt keeps view start_ i u lz ltac:(lra) ltac:(auto) hi j hu) as [? | [? | [? | [? | (x & hx & sx & lx)]]]]; auto 6.
  do 4 right; left. exists x. split; [| split; assumption]. split; [| lra].
  destruct (Rle_dec T x) as [? | before]; [assumption | exfalso].
  pose proof (advances s v x T ms ltac:(lra)). lra.
Qed.
(* A plan that enters before the other can arrive: until the ego is in the lane the other has not. *)
Lemma before_arrival i0 i u : (since <= i0 <= i)%nat -> (forall j, (i0 <= j < i)%nat -> carries_on k l c j) ->
  enters_at k l c b z i0 ->
  (let target := s_in z - own_s (ego_at l i0) + 3 * position_error k in
   0 <= clears_before k (theirs - t_most (b i0)) (rush k (w_most (b i0)) (fst (clearing k (least (departs_at k l c i0)) target)))) ->
  tau i0 <= u <= tau (S i) -> t u < theirs \/ s_in z <= s u.
Proof.
  cbn zeta. intros h carried [_ en] spare [lo hi]. unfold enters in en.
  destruct (where_ k s v tau c l log_ since start_ i0 i h) as (sT & vT & _).
  destruct (what k tau l ok t w b since mt keeps view start_ i0 i h) as [tT wT].
  destruct (command_range k s v tau c l obey log_ since start_ i0 i h) as [ca cp].
  assert (eps : 0 <= position_error k) by (destruct ok; lra).
  set (target := s_in z - own_s (ego_at l i0) + 3 * position_error k) in *.
  assert (it : in_time k (departs_at k l c i0) (goes l i0) target) by (destruct (clearing _ _ target); apply en).
  destruct (plan_clears k s v (tau i0) (tau (S i)) _ _ _ (own_v (ego_at l i0)) (goes l i0) ok ms
              (followed k s v tau c l ok ms grid obey log_ since start_ i0 i h carried) target
              ltac:(destruct vT; lra) cp (proj2 ca) it) as (c0 & _ & gone & _).
  change (departure k (own_v (ego_at l i0)) (previous_least l i0) (previous_most l i0) (c i0)) with (departs_at k l c i0) in c0, gone.
  set (clears := fst (clearing k (least (departs_at k l c i0)) target)) in *.
  destruct (Rle_dec u (tau i0 + clears)) as [early | late].
  - left. pose proof (has_not_arrived k t w (tau i0) u clears (theirs - t_most (b i0)) (w_most (b i0)) (t_most (b i0)) ok mt
      (from_T k tau l ok grid w since keeps start_ i0 i h) lo early ltac:(lra) ltac:(lra) spare). lra.
  - right. specialize (gone ltac:(lra)). pose proof (advances s v (tau i0 + clears) u ms ltac:(lra)). unfold target in gone. lra.
Qed.

(* How an ego comes to lead in a lane: by a plan that enters first, with the safe gap, unless it counts on precedence. *)
Lemma comes_to_lead g : s (tau since) < s_in z -> tau since < g -> leads z s t g ->
  (forall x, tau since <= x < g -> ~ leads z s t x) -> lead_from z < lead_to z ->
  s g < s_out z -> t g < t_out z ->
  (exists i0 i, relies i0 i /\ tau i <= g <= tau (S i)) \/
  exists i0 i, (since <= i0 <= i)%nat /\ (forall j, (i0 <= j < i)%nat -> carries_on k l c j) /\ tau i0 <= g <= tau (S i) /\
    enters_first k l c b z claimed theirs i0 /\ s (tau i0) < s_in z /\
    safe_gap k (w g) (v g) + slack k <= s g - t g - lead_to z.
Proof.
  intros before lo [sg lg] first band out out'. destruct (call_before k tau since g (period_pos k ok) grid lo) as (i & hi & [h1 h2]).
  assert (none : forall x, tau since <= x < g -> s_in z <= s x -> safe_gap k (w x) (v x) <= s x - t x - lead_to z -> False).
  { intros x hx sx G. apply (first x hx). split; [exact sx |].
    destruct (safe_gap_least k (w x) (v x) ok (forwards t w mt x) (forwards s v ms x)) as [_ G0]. lra. }
  destruct (its_judgement _ _ _ _ _ _ _ _ _ _ _ W i hi) as [[past | past] | [(i0 & h & se) | [(i0 & h & ver & carried) | (i0 & h & op & carried)]]].
  - exfalso. destruct (truth k s v tau c l log_ since start_ i ltac:(lia)) as ((_ & _ & least_) & _).
    pose proof (advances s v (tau i) g ms ltac:(lra)). lra.
  - exfalso. destruct (seen_well i hi) as [[tl _] _]. pose proof (advances t w (tau i) g mt ltac:(lra)). lra.
  - exfalso. destruct (settles_safely k s v tau c l ok ms grid obey log_ t w b z since mt keeps view start_ i0) as (x & hx & sx & G).
    + intros _ [least_ _]. destruct (truth k s v tau c l log_ since start_ since ltac:(lia)) as ((_ & _ & ?) & _). lra.
    + lia.
    + exact se.
    + pose proof (ordered i0 i ltac:(lia)). apply (none x ltac:(lra) sx). exact G.
  - pose proof (ordered i0 i ltac:(lia)). pose proof (ordered since i0 ltac:(lia)).
    destruct ver as [st | [st | en]].
    + exfalso. pose proof (rests_before k s v tau c l ok ms grid obey log_ z since start_ i0 i h carried g st ltac:(lra)). lra.
    + exfalso.
      pose proof (rests_behind k s v tau c l ok ms grid obey log_ t w b z since mt keeps view start_ i0 i h carried g st ltac:(lra)). lra.
    + right. pose proof en as [[_ en'] _].
      assert (outside : s (tau i0) < s_in z).
      { destruct (Rlt_le_dec (s (tau i0)) (s_in z)) as [? | inn]; [assumption | exfalso].
        destruct (enters_ahead_safely k s v tau c l ok ms grid obey log_ t w b z since mt keeps view start_ i0 i h carried (tau i0) en')
          as (x & hx & sx & _ & G); [lra | exact inn |].
        apply (none x ltac:(lra) sx). assert (0 < slack k) by (destruct ok; lra). lra. }
      exists i0, i. split; [exact h |]. split; [exact carried |]. split; [lra |]. split; [exact en |]. split; [exact outside |].
      destruct (enters_ahead_safely k s v tau c l ok ms grid obey log_ t w b z since mt keeps view start_ i0 i h carried g en')
        as (x & hx & sx & _ & G); [lra | exact sg |].
      destruct (Rlt_le_dec x g) as [sooner | now].
      * exfalso. apply (none x ltac:(lra) sx). assert (0 < slack k) by (destruct ok; lra). lra.
      * assert (x = g) as <- by lra. exact G.
  - left. exists i0, i. split; [| lra]. split; [exact h |]. split; assumption.
Qed.
End Shield.

(** * Two *)

(* The first time at which one leads, if it does. *)
Lemma first_lead z s v t w T u : motion s v -> motion t w -> (exists x, T <= x <= u /\ leads z s t x) ->
  exists g, T <= g <= u /\ leads z s t g /\ forall x, T <= x < g -> ~ leads z s t x.
Proof.
  intros ms mt (x & hx & sx & lx).
  assert (cs : forall q, continuous s q) by (intros; apply motion_continuous with v; exact ms).
  assert (ct : forall q, continuous t q) by (intros; apply motion_continuous with w; exact mt).
  destruct (first_time (fun q => s q - s_in z) (fun q => s q - t q - lead_to z) T x) as (g & hg & sg & lg & first);
    [ intros; apply (continuous_minus s (fun _ => s_in z)); [auto | apply continuous_const]
    | intros; apply (continuous_minus (fun q => s q - t q) (fun _ => lead_to z)); [apply (continuous_minus s t); auto | apply continuous_const]
    | lra | lra | lra |].
  exists g. split; [lra |]. split; [split; lra |]. intros p hp [sp lp]. apply (first p hp). lra.
Qed.

(* The ego counts on precedence while the other comes to lead. *)
Section Opener.
Variables (k : contract) (r : R) (z y : zone) (s v t w : R -> R) (mine theirs : R).
Variables (claimed : nat -> Prop) (tau c : nat -> R) (l : log) (b : nat -> bounds) (since : nat).
Variables (claimed' : nat -> Prop) (tau' c' : nat -> R) (l' : log) (b' : nat -> bounds) (since' : nat).
Hypothesis ok : valid k.
Hypothesis P6 : precedence_braking k <= ego_braking k.
Hypothesis rest : 0 <= r < unheld k.
Hypothesis P7 : creeps_behind k r.
Hypothesis lz : lane z = true.
Hypothesis ly : lane y = true.
Hypothesis mir : mirrored z y.
Hypothesis corner : lead_from z < s_in z - t_in z < lead_to z.
Hypothesis ms : motion s v.
Hypothesis mt : motion t w.
Hypothesis W : watches k (judged_in_lane k l c b z claimed since mine theirs) s v t w tau c l b since.
Hypothesis W' : watches k (judged_in_lane k l' c' b' y claimed' since' theirs mine) t w s v tau' c' l' b' since'.
Hypothesis order : forall i j, claimed i -> claimed' j -> newer k r tau i tau' j w \/ newer k r tau' j tau i v.
Let T := Rmax (tau since) (tau' since').
Hypothesis outside : s T < s_in z.
Hypothesis outside' : t T < t_in z.

Lemma its_outcome u : T <= u ->
  t u < t_in z \/ lead_to z <= s u - t u \/ t_out z <= t u \/ s_out z <= s u \/
  (exists x, T <= x <= u /\ leads y t s x) \/
  exists j0 j, relies k y theirs claimed' c' l' b' since' j0 j /\ tau' j <= u <= tau' (S j).
Proof.
  intros lo. destruct mir as (m1 & m2 & m3 & m4 & m5 & m6).
  pose proof (outcome k y t w s v theirs mine claimed' tau' c' l' b' since' ok ly mt ms W' T u (conj (Rmax_r _ _) lo)) as O.
  rewrite m1, m2, m4, m5 in O. destruct (O outside') as [? | [? | O']]; [left; assumption | right; left; lra | do 2 right; exact O'].
Qed.

Section Open.
Variables (i0 i : nat) (q : R).
Hypothesis relied : relies k z mine claimed c l b since i0 i.
Hypothesis until_ : q <= tau (S i).
Hypothesis within : s q < s_out z /\ t q < t_out z.
Hypothesis inn : s_in z < s q.

Let sl : 0 < slack k. Proof. destruct ok; lra. Qed.

Lemma still_out : t (tau i0) <= t_in z - slack k / 2.
Proof.
  destruct relied as ([h _] & (_ & _ & stop) & _).
  destruct (seen_well k z s v t w mine theirs claimed tau c l b since ok mt W i0 h) as [[_ tT] _].
  unfold rest_of in stop. cbn in stop.
  assert (0 <= w_most (b i0) * w_most (b i0) / (precedence_braking k + precedence_braking k)); [| lra].
  apply Rmult_le_pos; [apply Rle_0_sqr | left; apply Rinv_0_lt_compat; destruct ok; lra].
Qed.

(* An other that counts on precedence in the meantime is not in the lane. *)
Lemma both_rely j0 j p : relies k y theirs claimed' c' l' b' since' j0 j -> tau' j <= p <= tau' (S j) ->
  tau i0 <= p <= q -> t p < t_in z.
Proof.
  intros ([g1 g2] & (cl' & _ & stop') & carried') hp hq. destruct relied as ([h1 h2] & (cl & _ & stop) & carried).
  pose proof (its_start _ _ _ _ _ _ _ _ _ _ _ W). pose proof (its_start _ _ _ _ _ _ _ _ _ _ _ W').
  destruct (order i0 j0 cl cl') as [n | n].
  - pose proof (older_rests k r t w tau i0 tau' c' l' j0 j p (b i0) (t_in z - slack k / 2) ok P6 rest mt
      (its_calls _ _ _ _ _ _ _ _ _ _ _ W') (its_ego _ _ _ _ _ _ _ _ _ _ _ W') (its_log _ _ _ _ _ _ _ _ _ _ _ W')
      (seen_well k z s v t w mine theirs claimed tau c l b since ok mt W i0 h1) stop ltac:(lia) carried' ltac:(lra) n). lra.
  - exfalso. destruct mir as (_ & _ & m3 & _).
    pose proof (calls_ordered k tau' ok (its_calls _ _ _ _ _ _ _ _ _ _ _ W') j0 j g2).
    pose proof (older_rests k r s v tau' j0 tau c l i0 i q (b' j0) (t_in y - slack k / 2) ok P6 rest ms
      (its_calls _ _ _ _ _ _ _ _ _ _ _ W) (its_ego _ _ _ _ _ _ _ _ _ _ _ W) (its_log _ _ _ _ _ _ _ _ _ _ _ W)
      (seen_well k y t w s v theirs mine claimed' tau' c' l' b' since' ok ms W' j0 g1) stop' ltac:(lia) carried ltac:(lra) n). lra.
Qed.

(* An other that leads nevertheless has the ego behind it: by a claim that is newer than the ego's. *)
Lemma stays_behind_newer g : T <= g <= q -> leads y t s g -> (forall x, T <= x < g -> ~ leads y t s x) ->
  s q - t q <= lead_from z.
Proof.
  intros [g1 g2] [tg lg] first. destruct mir as (m1 & m2 & m3 & m4 & m5 & m6). rewrite m1 in tg. rewrite m6 in lg.
  destruct within as [sq tq].
  pose proof still_out as out0.
  pose proof (advances t w g q mt g2) as tgq. pose proof (advances s v g q ms g2) as sgq.
  assert (opened_before : tau i0 < g).
  { destruct (Rlt_le_dec (tau i0) g) as [? | le]; [assumption | exfalso]. pose proof (advances t w g (tau i0) mt le). lra. }
  assert (Tg : T < g).
  { destruct (Rlt_le_dec T g) as [? | le]; [assumption | exfalso]. assert (g = T) as -> by lra. lra. }
  assert (T' : tau' since' <= T) by apply Rmax_r.
  pose proof (advances t w (tau' since') T mt T').
  (* It does not lead by passing the ego in the lane. *)
  assert (at_border : t g <= t_in z).
  { destruct (Rle_lt_dec (t g) (t_in z)) as [? | beyond]; [assumption | exfalso].
    assert (cs : forall x, continuous s x) by (intros; apply motion_continuous with v; exact ms).
    assert (ct : forall x, continuous t x) by (intros; apply motion_continuous with w; exact mt).
    destruct (just_before (fun x => t x - t_in z) (Rmax T (tau i0)) g) as (p1 & h1 & beyond1);
      [apply (continuous_minus t (fun _ => t_in z)); [auto | apply continuous_const] | lra | cases; lra |].
    destruct (just_before (fun x => lead_to z - (s x - t x)) p1 g) as (p & h2 & close);
      [ apply (continuous_minus (fun _ => lead_to z) (fun x => s x - t x)); [apply continuous_const |]; apply (continuous_minus s t); auto
      | lra | lra |].
    assert (lo : T <= p /\ tau i0 <= p) by (pose proof (Rmax_l T (tau i0)); pose proof (Rmax_r T (tau i0)); lra).
    pose proof (beyond1 p ltac:(lra)). pose proof (close p ltac:(lra)).
    pose proof (advances t w p g mt ltac:(lra)). pose proof (advances s v p g ms ltac:(lra)).
    destruct (its_outcome p ltac:(lra)) as [? | [? | [? | [? | [(x & hx & lx) | (j0 & j & rel & hj)]]]]]; try lra.
    - apply (first x ltac:(lra) lx).
    - pose proof (both_rely j0 j p rel hj ltac:(lra)). lra. }
  destruct (comes_to_lead k y t w s v theirs mine claimed' tau' c' l' b' since' ok mt ms W' g)
    as [(j0 & j & rel & hj) | (j0 & j & hj & carried' & hg & [en turn] & not_yet & G)]; try (rewrite ?m1, ?m2, ?m4, ?m5, ?m6; lra).
  { split; [rewrite m1 | rewrite m6]; lra. }
  { intros x hx [tx lx]. destruct (Rle_dec T x) as [after_ | before].
    - apply (first x ltac:(lra)). split; assumption.
    - pose proof (advances t w x T mt ltac:(lra)). rewrite m1 in tx. lra. }
  { pose proof (both_rely j0 j g rel hj ltac:(lra)). lra. }
  destruct relied as (h & (cl & arrived & stop) & carried).
  pose proof (its_start _ _ _ _ _ _ _ _ _ _ _ W) as s1. pose proof (its_start _ _ _ _ _ _ _ _ _ _ _ W') as s1'.
  pose proof (its_calls _ _ _ _ _ _ _ _ _ _ _ W) as grid. pose proof (its_calls _ _ _ _ _ _ _ _ _ _ _ W') as grid'.
  destruct (where_ k s v tau c l (its_log _ _ _ _ _ _ _ _ _ _ _ W) since s1 i0 i h) as (_ & _ & here).
  destruct turn as [cl' | [inside_ | early]].
  - destruct (order i0 j0 cl cl') as [n | n].
    + exfalso. pose proof (older_rests k r t w tau i0 tau' c' l' j0 j g (b i0) (t_in z - slack k / 2) ok P6 rest mt grid'
        (its_ego _ _ _ _ _ _ _ _ _ _ _ W') (its_log _ _ _ _ _ _ _ _ _ _ _ W')
        (seen_well k z s v t w mine theirs claimed tau c l b since ok mt W i0 ltac:(lia)) stop ltac:(lia) carried' ltac:(lra) n). lra.
    + destruct n as (x & x' & slow & slow' & late & settled_ & before).
      pose proof (brakes_already k r s v tau c l x x' i0 i q ok rest ms grid (its_ego _ _ _ _ _ _ _ _ _ _ _ W)
        (its_log _ _ _ _ _ _ _ _ _ _ _ W) ltac:(lia) carried slow late settled_ ltac:(lra)) as B.
      assert (b0 : 0 < ego_braking k) by (destruct ok; lra).
      assert (sg : v g <= r).
      { pose proof (B x' g ltac:(lra) ltac:(lra) ltac:(lra)) as U. assert (0 <= ego_braking k * (g - x')) by nra.
        revert U. cases; lra. }
      pose proof (creeps_behind_leader k r s v t w g q (lead_from z - (s g - t g)) ok (proj1 rest) P7 ms mt g2) as C.
      rewrite m6 in G. assert (s q - s g <= t q - t g + (lead_from z - (s g - t g))); [| lra]. apply C.
      * intros p p' ? ? ?. apply B; lra.
      * intros p p' ? ? ?. apply (gentle k w tau' c' ok grid' (its_ego _ _ _ _ _ _ _ _ _ _ _ W') since' s1' j0); auto; [lia | lra].
      * exact sg.
      * lra.
  - exfalso. rewrite m1 in inside_, not_yet.
    destruct (where_ k t w tau' c' l' (its_log _ _ _ _ _ _ _ _ _ _ _ W') since' s1' j0 j hj) as (_ & _ & ?). lra.
  - exfalso.
    destruct (before_arrival k y t w s v theirs mine claimed' tau' c' l' b' since' ok mt ms W' j0 j
                (Rmax (tau i0) (tau' j0)) hj carried' en early) as [far | in_already].
    + split; [apply Rmax_r | apply Rmax_lub; lra].
    + pose proof (advances s v (tau i0) (Rmax (tau i0) (tau' j0)) ms (Rmax_l _ _)). lra.
    + rewrite m1 in in_already, not_yet. destruct (Rmax_spec (tau i0) (tau' j0)) as [[? e] | [? e]]; rewrite e in in_already; lra.
Qed.
End Open.

(* While the other leads first, the two are not in the lane together. *)
Lemma first_to_lead g u : T <= g <= u -> leads y t s g -> (forall x, T <= x < g -> ~ leads y t s x) ->
  (forall x, T <= x <= g -> ~ leads z s t x) -> ~ inside z (s u) (t u).
Proof.
  intros [g1 g2] [tg lg] first none ([si so] & [ti to_] & [l1 l2]).
  (* The ego is in the lane, not behind, and has not led. *)
  assert (relied : forall q, g <= q <= u -> s_in z < s q -> lead_from z < s q - t q -> (forall x, T <= x <= q -> ~ leads z s t x) -> False).
  { intros q hq sq lq never. pose proof (advances s v q u ms ltac:(lra)). pose proof (advances t w q u mt ltac:(lra)).
    assert (lo : T <= q) by lra.
    destruct (outcome k z s v t w mine theirs claimed tau c l b since ok lz ms mt W T q (conj (Rmax_l _ _) lo) outside)
      as [? | [? | [? | [? | [(x & hx & lx) | (i0 & i & rel & hi)]]]]]; try lra.
    - exact (never x hx lx).
    - pose proof (stays_behind_newer i0 i q rel ltac:(lra) ltac:(lra) sq g ltac:(lra) (conj tg lg) first). lra. }
  destruct (Classical_Prop.classic (exists x, T <= x <= u /\ leads z s t x)) as [ever | never].
  - destruct (first_lead z s v t w T u ms mt ever) as (gE & hE & [sE lE] & firstE).
    assert (later : g < gE).
    { destruct (Rlt_le_dec g gE) as [? | le]; [assumption | exfalso]. apply (none gE); [| split]; lra. }
    destruct mir as (m1 & _ & _ & _ & _ & m6). rewrite m1 in tg. rewrite m6 in lg.
    (* On the way from one lead to the other. *)
    set (m := (lead_to z + Rmax (lead_from z) (s_in z - t_in z)) / 2).
    assert (M : lead_from z < m /\ m < lead_to z /\ s_in z - t_in z < m) by (unfold m; cases; lra).
    destruct (IVT_gen (fun q => s q - t q) g gE m) as (q & hq & e).
    { intros q. apply continuity_pt_filterlim.
      apply (continuous_minus s t); [apply motion_continuous with v | apply motion_continuous with w]; assumption. }
    { cases; lra. }
    rewrite Rmin_left, Rmax_right in hq by lra. pose proof (advances t w g q mt ltac:(lra)).
    assert (q < gE) by (destruct (Req_dec q gE) as [-> | ne]; [exfalso; lra | lra]).
    apply (relied q); try lra. intros p hp. apply (firstE p). lra.
  - apply (relied u); try lra. intros p hp lp. apply never. exists p. auto.
Qed.
End Opener.

Theorem precedence_is_safe_in_lanes : Theorem4_lane.
Proof.
  intros k r z y s v t w mine theirs claimed tau c l b since claimed' tau' c' l' b' since' ok P6 rest P7 lz ly mir corner ms mt
    W W' order out out' u lo ins.
  set (T := Rmax (tau since) (tau' since')) in *.
  assert (T_ : Rmax (tau' since') (tau since) = T) by apply Rmax_comm.
  pose proof (inside_mirrored z y (s u) (t u) mir ins) as ins'.
  pose proof (mirrored_back z y mir) as mir'. pose proof mir as (m1 & m2 & m3 & m4 & m5 & m6).
  assert (order' : forall j i, claimed' j -> claimed i -> newer k r tau' j tau i v \/ newer k r tau i tau' j w).
  { intros j i cj ci. apply or_comm, order; assumption. }
  (* Neither leads before the other, so none does. *)
  assert (F : forall g, T <= g <= u -> leads y t s g -> (forall x, T <= x < g -> ~ leads y t s x) ->
            (forall x, T <= x <= g -> ~ leads z s t x) -> False).
  { intros g h L first none. apply (first_to_lead k r z y s v t w mine theirs claimed tau c l b since claimed' tau' c' l' b' since'
      ok P6 rest P7 lz ly mir corner ms mt W W' order out out' g u h L first none ins). }
  assert (E : forall g, T <= g <= u -> leads z s t g -> (forall x, T <= x < g -> ~ leads z s t x) ->
            (forall x, T <= x <= g -> ~ leads y t s x) -> False).
  { intros g h L first none. apply (first_to_lead k r y z t w s v theirs mine claimed' tau' c' l' b' since' claimed tau c l b since
      ok P6 rest P7 ly lz mir' ltac:(rewrite m1, m3, m5, m6; lra) mt ms W' W order') with (g := g) (u := u); rewrite ?T_, ?m1, ?m3; auto. }
  destruct (Classical_Prop.classic (exists x, T <= x <= u /\ leads z s t x)) as [LE | noE];
    destruct (Classical_Prop.classic (exists x, T <= x <= u /\ leads y t s x)) as [LF | noF].
  - destruct (first_lead z s v t w T u ms mt LE) as (gE & hE & lE & firstE).
    destruct (first_lead y t w s v T u mt ms LF) as (gF & hF & lF & firstF).
    assert (ne : gE <> gF). { intros ->. destruct lE as [_ ?], lF as [_ lF]. rewrite m6 in lF. lra. }
    destruct (Rle_dec gE gF) as [le | gt].
    + apply (E gE hE lE firstE). intros x hx. apply firstF. lra.
    + apply (F gF hF lF firstF). intros x hx. apply firstE. lra.
  - destruct (first_lead z s v t w T u ms mt LE) as (gE & hE & lE & firstE).
    apply (E gE hE lE firstE). intros x hx lx. apply noF. exists x. split; [lra | exact lx].
  - destruct (first_lead y t w s v T u mt ms LF) as (gF & hF & lF & firstF).
    apply (F gF hF lF firstF). intros x hx lx. apply noE. exists x. split; [lra | exact lx].
  - (* Both count on precedence: the one whose claim is older stays out. *)
    destruct ins as ([si so] & [ti to_] & [l1 l2]).
    destruct (outcome k z s v t w mine theirs claimed tau c l b since ok lz ms mt W T u (conj (Rmax_l _ _) lo) out)
      as [? | [? | [? | [? | [? | (i0 & i & rel & hi)]]]]]; try lra; [contradiction |].
    destruct (its_outcome k z y s v t w mine theirs tau since claimed' tau' c' l' b' since' ok ly mir ms mt W' out' u lo)
      as [? | [? | [? | [? | [? | (j0 & j & rel' & hj)]]]]]; try lra; [contradiction |].
    pose proof (both_rely k r z y s v t w mine theirs claimed tau c l b since claimed' tau' c' l' b' since' ok P6 rest mir ms mt W W'
      order i0 i u rel ltac:(lra) si j0 j u rel' hj) as B.
    assert (tau i0 <= tau i) by (apply (calls_ordered k tau ok (its_calls _ _ _ _ _ _ _ _ _ _ _ W)); apply rel).
    specialize (B ltac:(lra)). lra.
Qed.

Theorem precedence_keeps_apart : Theorem4.
Proof.
  intros k r zones occupied s v t w mine theirs tau c l b since tau' c' l' b' since' ok P6 rest P7 cov ms mt all u lo occ.
  destruct (cov (s u) (t u) occ) as (z & zin & ins). destruct (all z zin) as (y & claimed & claimed' & ly & mir & kind).
  assert (which : lane z = true \/ lane z = false) by (destruct (lane z); auto).
  destruct which as [la | la]; rewrite la in kind, ly.
  - destruct kind as (corner & out & out' & W & W' & order).
    exact (precedence_is_safe_in_lanes k r z y s v t w mine theirs claimed tau c l b since claimed' tau' c' l' b' since' ok P6 rest P7
             la ly mir corner ms mt W W' order out out' u lo ins).
  - destruct kind as (W & W' & order).
    exact (precedence_is_safe_at_crossings k r z y s v t w claimed tau c l b since claimed' tau' c' l' b' since' ok P6 rest
             la ly mir ms mt W W' order u lo ins).
Qed.

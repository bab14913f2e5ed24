(* (iii) What a verified plan and a follower's duty keep apart: one zone, one other. *)
Require Import Reals Lra Lia Psatz.
Require Import Contract Shipped Motion Reach Statement Ego Plan.
Open Scope R_scope.

(** * Bounds on an other *)

(* (i) 1, L29, L30: an other is within its bounds, whether it is seen or coasts. *)
Lemma known_holds k t w from u b :
  valid k -> motion t w -> keeps_contract k w from -> known k t w from u b ->
  from <= u /\ hold b (t u) (w u).
Proof.
  intros ok m keeps kn. pose proof (forwards t w m) as pos. unfold hold.
  induction kn as [u place v lo pl vl | u u' b kn [lo IH] le | u u' b former k1 [lo1 IH1] k2 [lo2 IH2] le
    | u place least speed_ lo pl vl | u b b' k1 [lo1 IH1] k2 [_ IH2]].
  - split; [exact lo |]. pose proof (pos u). cbn. split; [lra |]. split; cases; lra.
  - split; [lra |].
    assert (a0 : 0 < other_acceleration k) by (destruct ok; lra).
    assert (b0 : 0 < other_braking k) by (destruct ok; lra).
    pose proof (pos u) as pu.
    pose proof (at_least_holds t w (t u) (- other_braking k) 0 (start (w_least b)) u u' m le) as A.
    pose proof (rushing_holds t w (t u) (other_acceleration k) (other_max_speed k) (start (w_most b)) u u' m a0 le) as B.
    rewrite <- dawdle_is in A. rewrite <- rush_is in B. unfold after. cbn [t_least t_most w_least w_most].
    destruct A as [A1 A2].
    { intros x y ? ? ?. pose proof (brakes k w from keeps u' x y ltac:(lra) ltac:(lra) ltac:(lra)).
      apply Rle_trans with (1 := Rmin_l _ _). lra. }
    { apply Rmax_r. }
    { cbn. lra. }
    { cbn. cases; lra. }
    destruct B as [B1 B2].
    { intros x y ? ? ?. apply (rushes k w from keeps u'); lra. }
    { cbn. lra. }
    { cbn. cases; lra. }
    lra.
  - split; [exact lo2 |]. pose proof (advances t w u u' m le). cbn. split; [| lra]. split; [| lra]. cases; lra.
  - split; [exact lo |]. pose proof (pos u). cbn. lra.
  - split; [exact lo1 |]. cbn. split; split; cases; lra.
Qed.

(** * Crossing *)

(* L20: an other has not reached its zone before the ego has cleared its own. *)
Lemma has_not_arrived k t w T u clears away W place :
  valid k -> motion t w -> keeps_contract k w T -> T <= u -> u <= T + clears ->
  t T <= place -> w T <= W -> 0 <= clears_before k away (rush k W clears) -> t u < place + away.
Proof.
  intros ok m keeps lo hi tT wT spare.
  assert (a0 : 0 < other_acceleration k) by (destruct ok; lra).
  assert (sl : 0 < slack k) by (destruct ok; lra).
  pose proof (rushing_holds t w (t T) (other_acceleration k) (other_max_speed k) (start W) T u m a0 lo) as B.
  destruct B as [B _].
  { intros x y ? ? ?. apply (rushes k w T keeps u); lra. }
  { cbn. lra. }
  { cbn. cases; lra. }
  pose proof (rushing_grows (start W) (other_acceleration k) (other_max_speed k) (u - T) clears a0 ltac:(lra) (Rmax_r _ _)).
  unfold clears_before in spare. rewrite rush_is in spare. lra.
Qed.

(** * Behind in a lane *)

(* L21, L22: the gap to a leader that brakes as hard as it can is open now, and open when both are at rest, so it is open
   always. The ego brakes at [hard] at most; [rests] bounds where it would be at rest if it braked at [b] from any moment on. *)
Lemma stays_behind k hard b s v t w T E rests gap W :
  valid k -> hard <= other_braking k -> 0 < b <= other_braking k -> motion s v -> motion t w -> keeps_contract k w T ->
  (forall x y, T <= x -> x <= y -> y <= E -> v x - hard * (y - x) <= v y) ->
  (forall x, T <= x <= E -> s x - s T + v x * v x / (b + b) <= rests) ->
  0 <= gap ->
  0 <= W <= w T -> rests <= gap + W * W / (other_braking k + other_braking k) ->
  forall u, T <= u <= E -> s u - t u <= s T - t T + gap.
Proof.
  intros ok hb [b0 bb] ms mt keeps gentle stop g0 [W0 Ww] enough u [lo hi].
  set (bh := other_braking k) in *.
  pose proof (forwards s v ms) as vpos. pose proof (forwards t w mt) as wpos.
  assert (low : forall x, T <= x -> W - bh * (x - T) <= w x).
  { intros x ?. pose proof (brakes k w T keeps x T x ltac:(lra) ltac:(lra) ltac:(lra)). fold bh in H0. lra. }
  destruct (Rle_dec (v u) (W - bh * (u - T))) as [opens | closes].
  - pose proof (gap_opens t w s v T u mt ms lo) as G.
    assert (s u - s T <= t u - t T); [| lra].
    apply G. intros x [? ?]. pose proof (gentle x u ltac:(lra) ltac:(lra) ltac:(lra)). pose proof (low x ltac:(lra)).
    assert (hard * (u - x) <= bh * (u - x)) by (apply Rmult_le_compat_r; lra). nra.
  - pose proof (stop u ltac:(lra)) as R. pose proof (vpos u).
    assert (far : W * W / (bh + bh) - Rmax (W - bh * (u - T)) 0 * Rmax (W - bh * (u - T)) 0 / (bh + bh) <= t u - t T).
    { destruct (Rle_dec 0 (W - bh * (u - T))) as [moving | rest].
      - rewrite Rmax_left by lra.
        pose proof (above_line t w W (- bh) T u mt lo) as A.
        specialize (A ltac:(intros; pose proof (low t0 ltac:(lra)); lra)).
        replace (W * W / (bh + bh) - (W - bh * (u - T)) * (W - bh * (u - T)) / (bh + bh))
          with (W * (u - T) + - bh * (u - T) * (u - T) / 2) by (field; lra). exact A.
      - rewrite Rmax_right by lra.
        set (x := W / bh). assert (X : bh * x = W) by (unfold x; field; lra).
        assert (x0 : 0 <= x) by (unfold x; apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
        assert (xu : T + x <= u) by nra.
        pose proof (above_line t w W (- bh) T (T + x) mt ltac:(lra)) as A.
        specialize (A ltac:(intros; pose proof (low t0 ltac:(lra)); lra)).
        pose proof (advances t w (T + x) u mt xu).
        replace (T + x - T) with x in A by ring.
        replace (W * W / (bh + bh) - 0 * 0 / (bh + bh)) with (W * x + - bh * x * x / 2); [lra |].
        rewrite <- X. field. lra. }
    set (z := Rmax (W - bh * (u - T)) 0) in *.
    assert (zv : 0 <= z <= v u) by (unfold z; cases; lra).
    assert (z * z / (bh + bh) <= v u * v u / (b + b)).
    { apply Rle_trans with (v u * v u / (bh + bh)).
      - apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | nra].
      - apply Rmult_le_compat_l; [nra | apply Rinv_le_contravar; lra]. }
    lra.
Qed.

(** * Ahead in a lane *)

Lemma rest_of_rushing_grows r a cap b x y :
  0 < a -> 0 < b -> 0 <= x <= y -> 0 <= speed r ->
  rest_of (rushing r a cap x) b <= rest_of (rushing r a cap y) b.
Proof.
  intros a0 b0 [x0 xy] r0. unfold rest_of.
  pose proof (rushing_grows r a cap x y a0 ltac:(lra) r0).
  pose proof (rushing_speed_grows r a cap x y a0 xy).
  assert (0 <= speed (rushing r a cap x)).
  { cbn. pose proof (Rmax_r cap (speed r)). assert (0 <= a * x) by nra. cases; lra. }
  assert (speed (rushing r a cap x) * speed (rushing r a cap x) / (b + b)
          <= speed (rushing r a cap y) * speed (rushing r a cap y) / (b + b)).
  { apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | nra]. }
  lra.
Qed.

Lemma hardest_pos k : valid k -> 0 < hardest k /\ ego_braking k <= hardest k /\ follower_braking k <= hardest k.
Proof. intros []. unfold hardest. pose proof (Rmax_l (ego_braking k) (follower_braking k)).
  pose proof (Rmax_r (ego_braking k) (follower_braking k)). lra. Qed.

(* The safe gap, without the start of a reach. *)
Lemma safe_gap_nonneg k w v :
  0 <= v -> safe_gap k w v =
    Rmax (rest_of (rush k w (follower_reaction k)) (follower_braking k) - v * v / (hardest k + hardest k)) 0.
Proof.
  intros v0. rewrite safe_gap_is. do 2 f_equal. unfold rest_of, start. cbn. rewrite (Rmax_left v) by lra. lra.
Qed.

(* L21, L23: with the safe gap, a follower that brakes after its reaction time never comes nearer than the band. *)
Lemma stays_ahead k s v t w z T u :
  valid k -> motion s v -> motion t w -> T <= u ->
  rushes_at_most w (other_acceleration k) (other_max_speed k) T u ->
  speeds_up_at_most w (- follower_braking k) (T + follower_reaction k) u ->
  (forall x y, T <= x -> x <= y -> y <= u -> v x - ego_braking k * (y - x) <= v y) ->
  safe k z (s T) (v T) (t T) (w T) -> lead_to z <= s u - t u.
Proof.
  intros ok ms mt lo up react gentle gap. unfold safe in gap.
  pose proof (forwards s v ms) as vpos. pose proof (forwards t w mt) as wpos.
  rewrite safe_gap_nonneg in gap by apply vpos.
  destruct (hardest_pos k ok) as (B0 & Bb & Bf).
  assert (a0 : 0 < other_acceleration k) by (destruct ok; lra).
  assert (f0 : 0 < follower_braking k) by (destruct ok; lra).
  assert (b0 : 0 < ego_braking k) by (destruct ok; lra).
  assert (rho0 : 0 <= follower_reaction k) by (destruct ok; lra).
  set (B := hardest k) in *. set (f := follower_braking k) in *. set (rho := follower_reaction k) in *.
  set (r := start (w T)) in *.
  set (R := fun x => rushing r (other_acceleration k) (other_max_speed k) x).
  assert (r0 : 0 <= speed r) by apply Rmax_r.
  assert (G0 : 0 <= s T - t T - lead_to z) by (apply Rle_trans with (2 := gap); apply Rmax_r).
  assert (G1 : rest_of (R rho) f - v T * v T / (B + B) <= s T - t T - lead_to z)
    by (apply Rle_trans with (2 := gap); apply Rmax_l).
  assert (within : forall x, T <= x <= u -> t x - t T <= distance (R (x - T)) /\ w x <= speed (R (x - T))).
  { intros x [? ?]. apply (rushing_holds t w (t T)); auto; try lra.
    - intros p q ? ? ?. apply up; lra.
    - cbn. lra.
    - cbn. pose proof (wpos T). cases; lra. }
  assert (Rs : forall x y, x <= y -> speed (R x) <= speed (R y)) by (intros; apply rushing_speed_grows; auto).
  assert (Rpos : forall x, 0 <= x -> 0 <= speed (R x)).
  { intros x ?. unfold R. cbn. pose proof (Rmax_r (other_max_speed k) (Rmax (w T) 0)).
    pose proof (Rmax_r (w T) 0). assert (0 <= other_acceleration k * x) by nra. cases; lra. }
  (* The speed of the follower at its worst. *)
  set (worst := fun x => if Rle_dec x rho then speed (R x) else Rmax (speed (R rho) - f * (x - rho)) 0).
  assert (ww : forall x, T <= x <= u -> w x <= worst (x - T)).
  { intros x [? ?]. unfold worst. destruct (Rle_dec (x - T) rho); [apply within; lra |].
    pose proof (react (T + rho) x ltac:(lra) ltac:(lra) ltac:(lra)) as W1.
    destruct (within (T + rho) ltac:(lra)) as [_ W2]. replace (T + rho - T) with rho in W2 by ring.
    replace (x - (T + rho)) with (x - T - rho) in W1 by ring. revert W1. cases; lra. }
  assert (falls : forall x, 0 <= x <= u - T -> worst x <= worst (u - T) + f * (u - T - x)).
  { intros x [? ?]. unfold worst.
    assert (0 <= f * (u - T - x)) by (apply Rmult_le_pos; lra).
    destruct (Rle_dec x rho), (Rle_dec (u - T) rho); try lra.
    - pose proof (Rs x (u - T) ltac:(lra)). lra.
    - pose proof (Rs x rho ltac:(lra)). assert (f * (u - T - rho) <= f * (u - T - x)) by (apply Rmult_le_compat_l; lra).
      cases; lra.
    - cases; lra. }
  assert (egolow : forall x, T <= x <= u -> v T - B * (x - T) <= v x).
  { intros x [? ?]. pose proof (gentle T x ltac:(lra) ltac:(lra) ltac:(lra)).
    assert (ego_braking k * (x - T) <= B * (x - T)) by (apply Rmult_le_compat_r; lra). lra. }
  destruct (Rle_dec (worst (u - T)) (v T - B * (u - T))) as [opens | closes].
  - pose proof (gap_opens s v t w T u ms mt lo) as G.
    assert (t u - t T <= s u - s T); [| lra].
    apply G. intros x [? ?]. pose proof (ww x ltac:(lra)). pose proof (falls (x - T) ltac:(lra)).
    pose proof (egolow x ltac:(lra)).
    assert (f * (u - T - (x - T)) <= B * (u - T - (x - T))) by (apply Rmult_le_compat_r; lra). nra.
  - set (vf := worst (u - T)) in *. set (ve := Rmax (v T - B * (u - T)) 0).
    (* The follower is as far from its rest as its worst speed takes. *)
    assert (vf0 : 0 <= vf).
    { unfold vf, worst. destruct (Rle_dec (u - T) rho); [apply Rpos; lra | apply Rmax_r]. }
    assert (far : t u - t T <= rest_of (R rho) f - vf * vf / (f + f)).
    { unfold vf, worst. destruct (Rle_dec (u - T) rho) as [early | late].
      - destruct (within u ltac:(lra)) as [d _].
        pose proof (rest_of_rushing_grows r (other_acceleration k) (other_max_speed k) f (u - T) rho a0 f0 ltac:(lra) r0) as M.
        fold (R (u - T)) (R rho) in M. unfold rest_of in M at 1. lra.
      - destruct (within (T + rho) ltac:(lra)) as [d1 v1]. replace (T + rho - T) with rho in d1, v1 by ring.
        unfold rest_of. set (V := speed (R rho)) in *.
        destruct (Rle_dec 0 (V - f * (u - T - rho))) as [moving | rest].
        + rewrite Rmax_left by lra.
          pose proof (below_line t w V (- f) (T + rho) u mt ltac:(lra)) as A.
          assert (line : forall x, T + rho <= x <= u -> w x <= V + - f * (x - (T + rho))).
          { intros x [? ?]. pose proof (react (T + rho) x ltac:(lra) ltac:(lra) ltac:(lra)) as W1.
            assert (f * (x - (T + rho)) <= f * (u - T - rho)) by (apply Rmult_le_compat_l; lra).
            revert W1. cases; lra. }
          specialize (A line).
          replace (distance (R rho) + V * V / (f + f) - (V - f * (u - T - rho)) * (V - f * (u - T - rho)) / (f + f))
            with (distance (R rho) + (V * (u - (T + rho)) + - f * (u - (T + rho)) * (u - (T + rho)) / 2)) by (field; lra).
          lra.
        + rewrite Rmax_right by lra.
          pose proof (stops_by t w f V (T + rho) u mt f0 ltac:(lra) react v1) as S.
          replace (0 * 0 / (f + f)) with 0 by (field; lra). lra. }
    assert (near : v T * v T / (B + B) - ve * ve / (B + B) <= s u - s T).
    { unfold ve. destruct (Rle_dec 0 (v T - B * (u - T))) as [moving | rest].
      - rewrite Rmax_left by lra.
        pose proof (above_line s v (v T) (- B) T u ms lo) as A.
        specialize (A ltac:(intros x ?; pose proof (egolow x ltac:(lra)); lra)).
        replace (v T * v T / (B + B) - (v T - B * (u - T)) * (v T - B * (u - T)) / (B + B))
          with (v T * (u - T) + - B * (u - T) * (u - T) / 2) by (field; lra). exact A.
      - rewrite Rmax_right by lra.
        set (x := v T / B). assert (X : B * x = v T) by (unfold x; field; lra).
        assert (x0 : 0 <= x) by (unfold x; apply Rmult_le_pos; [apply vpos | left; apply Rinv_0_lt_compat; lra]).
        assert (xu : T + x <= u) by nra.
        pose proof (above_line s v (v T) (- B) T (T + x) ms ltac:(lra)) as A.
        specialize (A ltac:(intros y ?; pose proof (egolow y ltac:(lra)); lra)).
        pose proof (advances s v (T + x) u ms xu).
        replace (T + x - T) with x in A by ring.
        replace (v T * v T / (B + B) - 0 * 0 / (B + B)) with (v T * x + - B * x * x / 2); [lra |].
        rewrite <- X. field. lra. }
    assert (ve0 : 0 <= ve <= vf) by (unfold ve; cases; lra).
    assert (ve * ve / (B + B) <= vf * vf / (f + f)).
    { apply Rle_trans with (vf * vf / (B + B)).
      - apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | nra].
      - apply Rmult_le_compat_l; [nra | apply Rinv_le_contravar; lra]. }
    lra.
Qed.

(* A slower follower needs no more of a gap, nor one behind a faster ego. *)
Lemma safe_gap_monotone k w w' v v' :
  valid k -> w <= w' -> 0 <= v' -> v' <= v -> safe_gap k w v <= safe_gap k w' v'.
Proof.
  intros ok ww v0 vv. rewrite !safe_gap_nonneg by lra.
  assert (a0 : 0 < other_acceleration k) by (destruct ok; lra).
  assert (f0 : 0 < follower_braking k) by (destruct ok; lra).
  assert (rho0 : 0 <= follower_reaction k) by (destruct ok; lra).
  destruct (hardest_pos k ok) as (B0 & _).
  apply Rle_max_compat_r. unfold rest_of. rewrite !rush_is. unfold start.
  destruct (rushing_monotone 0 (Rmax w 0) (Rmax w' 0) (other_acceleration k) (other_max_speed k) (follower_reaction k))
    as [d s]; auto; [apply Rle_max_compat_r; lra |].
  assert (p : 0 <= speed (rushing {| distance := 0; speed := Rmax w 0 |} (other_acceleration k) (other_max_speed k) (follower_reaction k))).
  { cbn. pose proof (Rmax_r (other_max_speed k) (Rmax w 0)). pose proof (Rmax_r w 0).
    assert (0 <= other_acceleration k * follower_reaction k) by nra. cases; lra. }
  set (x := speed (rushing {| distance := 0; speed := Rmax w 0 |} _ _ _)) in *.
  set (y := speed (rushing {| distance := 0; speed := Rmax w' 0 |} _ _ _)) in *.
  assert (x * x / (follower_braking k + follower_braking k) <= y * y / (follower_braking k + follower_braking k)).
  { apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | nra]. }
  assert (v' * v' / (hardest k + hardest k) <= v * v / (hardest k + hardest k)).
  { apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | nra]. }
  lra.
Qed.
